"""Surrogates on disk: one .npz of arrays with a JSON header that says what they are."""

import json
import zipfile
from dataclasses import asdict
from pathlib import Path
from typing import Any, Literal

import numpy as np

from flexsurr.simulation.rhs import Model
from flexsurr.storage import replacing
from flexsurr.surrogates.compiled import compiled
from flexsurr.surrogates.dissipative_hnn import DissipativeHNN
from flexsurr.surrogates.hnn import HNN
from flexsurr.surrogates.mlp import MLP
from flexsurr.surrogates.polynomial import PolynomialHamiltonian
from flexsurr.surrogates.port_hamiltonian_network import NetworkPortHamiltonian
from flexsurr.surrogates.port_hamiltonian_polynomial import PolynomialPortHamiltonian
from flexsurr.surrogates.scaling import FeatureScaling, PairScaling, Scaling, StateScaling
from flexsurr.surrogates.surrogate import Surrogate

FORMAT = "flexsurr surrogate 1"
NETWORKS = {network.architecture: network for network in (MLP, HNN, DissipativeHNN)}


class SurrogateFileError(Exception):
    """A file that cannot be read as a surrogate; the message names it."""


def save(surrogate: Surrogate, path: str | Path) -> None:
    """Write `surrogate` to `path` whole: beside its place first, then moved there."""
    header = {
        "format": FORMAT,
        "architecture": surrogate.architecture,
        "state_names": surrogate.state_names,
        "state_units": surrogate.state_units,
        "scaling": asdict(surrogate.scaling),
        **surrogate.settings(),
    }
    arrays = {"header": np.array(json.dumps(header)), "parameters": surrogate.parameters}
    if isinstance(surrogate, PolynomialHamiltonian | PolynomialPortHamiltonian):
        arrays["exponents"] = surrogate.exponents
    if isinstance(surrogate, NetworkPortHamiltonian):
        arrays["floor"] = surrogate.floor
    with replacing(Path(path)) as beside, beside.open("wb") as file:
        np.savez(file, allow_pickle=False, **arrays)


def load(path: str | Path) -> Surrogate:
    """The surrogate in `path`. Raises SurrogateFileError for a damaged or foreign file, OSError for none."""
    try:
        with Path(path).open("rb") as content, np.load(content, allow_pickle=False) as file:
            arrays = dict(file)
    except FileNotFoundError:
        raise
    except (OSError, EOFError, ValueError, TypeError, zipfile.BadZipFile) as error:
        raise SurrogateFileError(f"{path}: not a readable .npz file ({error})") from None
    try:
        header = json.loads(str(arrays["header"]))
        if header["format"] != FORMAT:
            raise SurrogateFileError(f"{path}: format {header['format']!r}, expected {FORMAT!r}")
        return _surrogate(header, arrays)
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        detail = f"no {error}" if isinstance(error, KeyError) else error
        raise SurrogateFileError(f"{path}: not a surrogate of flexsurr ({detail})") from None


def _surrogate(header: dict[str, Any], arrays: dict[str, np.ndarray]) -> Surrogate:
    parameters = np.ascontiguousarray(arrays["parameters"], dtype=np.float64)
    if not np.all(np.isfinite(parameters)):
        raise ValueError("parameters that are not finite")
    common: dict[str, Any] = {
        "parameters": parameters,
        "scaling": _scaling(header["scaling"]),
        "state_names": tuple(header["state_names"]),
        "state_units": tuple(header["state_units"]),
    }
    architecture = header["architecture"]
    polynomial = {
        PolynomialHamiltonian.architecture: PolynomialHamiltonian,
        PolynomialPortHamiltonian.architecture: PolynomialPortHamiltonian,
    }.get(architecture)
    if polynomial is not None and "hidden" not in header:
        return polynomial(**common, exponents=arrays["exponents"].astype(np.int64, casting="safe"))
    common |= {"hidden": tuple(header["hidden"]), "activation": header["activation"]}
    if architecture == NetworkPortHamiltonian.architecture:
        floor = np.ascontiguousarray(arrays["floor"], dtype=np.float64)
        return NetworkPortHamiltonian(**common, floor=floor, even=bool(header["even"]))
    return NETWORKS[architecture](**common)


def _scaling(values: dict[str, Any]) -> StateScaling:
    if "action" in values:
        return PairScaling(q=tuple(values["q"]), action=values["action"], energy=values["energy"])
    if "dx" in values:
        return FeatureScaling(x=tuple(values["x"]), dx=tuple(values["dx"]))
    return Scaling(**values)


def load_model(path: str | Path, implementation: Literal["numpy", "compiled"]) -> Model:
    """The surrogate in `path` as a model in plain NumPy or compiled."""
    surrogate = load(path)
    if implementation == "numpy":
        return surrogate
    if implementation == "compiled":
        return compiled(surrogate)
    raise ValueError(f"implementation {implementation!r} is not one of numpy, compiled")
