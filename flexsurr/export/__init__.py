"""Models outside of Python: C, NumPy alone, ONNX, FMU, all printed from one description of a model."""

from flexsurr.export.aircraft import exported_aircraft
from flexsurr.export.c_header import c_header
from flexsurr.export.fmu import fmu
from flexsurr.export.formulas import NotExported
from flexsurr.export.model import ExportedModel, Quantity, exported_map, exported_surrogate
from flexsurr.export.numpy_file import numpy_file
from flexsurr.export.onnx_file import onnx_file

__all__ = [
    "ExportedModel",
    "NotExported",
    "Quantity",
    "c_header",
    "exported_aircraft",
    "exported_map",
    "exported_surrogate",
    "fmu",
    "numpy_file",
    "onnx_file",
]
