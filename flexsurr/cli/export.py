"""Surrogates for other programs."""

import argparse
from collections.abc import Callable
from pathlib import Path

from flexsurr.aerodynamics.features import COEFFICIENT_UNITS, COEFFICIENTS, FEATURE_UNITS, FEATURES
from flexsurr.beam import EquilibriumNotFound
from flexsurr.cli.command import for_people
from flexsurr.config.aircraft import load_aircraft
from flexsurr.config.sample_study import SampleStudy
from flexsurr.config.study_files import StudyFiles
from flexsurr.export import (
    ExportedModel,
    NotExported,
    c_header,
    exported_aircraft,
    exported_map,
    exported_surrogate,
    fmu,
    numpy_file,
    onnx_file,
)
from flexsurr.export.aircraft import check_aerodynamics
from flexsurr.flight import free_modes, stick_model
from flexsurr.flight.model import FlightModel
from flexsurr.flight.trim import TrimNotFound, trim
from flexsurr.storage import replacing
from flexsurr.surrogates import LearnedMap, SurrogateFileError, load_map
from flexsurr.surrogates.saved import MAP_FORMAT, form_of
from flexsurr.training.saved_surrogate import load_surrogate

FORMS: dict[str, tuple[str, Callable[[ExportedModel], str | bytes]]] = {
    "c": (".h", c_header),
    "numpy": (".py", numpy_file),
    "onnx": (".onnx", onnx_file),
    "fmu": (".fmu", fmu),
}
"""The ending of each form, and what writes it."""

RUNS = Path("results/runs")

WEIGHTS = "weights.npz"

UNITS = dict(zip((*FEATURES, *COEFFICIENTS), (*FEATURE_UNITS, *COEFFICIENT_UNITS), strict=True))


def _export_arguments(parser: argparse.ArgumentParser) -> None:
    """The run, the form, and where it goes."""
    parser.add_argument("run", help=f"a run's name, its folder or its {WEIGHTS}")
    parser.add_argument("--to", choices=FORMS, required=True, help="the form")
    parser.add_argument(
        "--aircraft",
        metavar="STUDY",
        help="the whole aircraft of a study of samples, in trim, with the run as its aerodynamics",
    )
    parser.add_argument("--name", help="what it is called in the form, by default as its run")
    parser.add_argument(
        "--output",
        type=Path,
        metavar="FILE",
        help="by default the name with the form's ending, in this folder",
    )


@for_people(_export_arguments, SurrogateFileError, OSError, NotExported, EquilibriumNotFound, TrimNotFound)
def export(run: str, to: str, aircraft: str | None, name: str | None, output: Path | None) -> None:
    """Export a surrogate as a C header, a NumPy file, ONNX, or an FMU for Simulink or OpenModelica.

    Raises SurrogateFileError and OSError for a file that is no surrogate, NotExported for one that has no
    such form, TrimNotFound for an aircraft that has no trim with it.
    """
    path = _weights(run)
    run_id = path.parent.name if path.name == WEIGHTS else path.stem
    model = (
        _model(path, run_id, name) if aircraft is None else _aircraft(load_map(path), run_id, aircraft, name)
    )
    ending, write = FORMS[to]
    content = write(model)
    output = output or Path(f"{model.name}{ending}")
    with replacing(output) as beside:
        beside.write_bytes(content.encode() if isinstance(content, str) else content)
    print(output)


def _weights(run: str) -> Path:
    """The file of a run, whichever way it is named."""
    for path in (Path(run), Path(run) / WEIGHTS, RUNS / run / WEIGHTS):
        if path.is_file():
            return path
    raise NotExported(f"{run}: no such run; allowed: a name below {RUNS}, a run's folder, its {WEIGHTS}")


def _model(path: Path, run_id: str, name: str | None) -> ExportedModel:
    if form_of(path) != MAP_FORMAT:
        return exported_surrogate(load_surrogate(path), name)
    learned = load_map(path)
    units = [[UNITS.get(of, "") for of in names] for names in (learned.inputs.names, learned.output_names)]
    return exported_map(learned, run_id, name, *units)


def _aircraft(learned: LearnedMap, run_id: str, study: str, name: str | None) -> ExportedModel:
    """The aircraft of a study in straight and level flight, at the study's own condition."""
    check_aerodynamics(learned, run_id)
    settings = StudyFiles(Path(), study, []).record(SampleStudy)
    flight = settings.flight
    modes = free_modes(stick_model(load_aircraft(Path(settings.aircraft))), flight.elastic_modes)
    model = FlightModel(modes, learned.compiled(), chosen=flight.aerodynamic_modes)
    level = trim(model, flight.condition, flight.limits)
    about = (
        f"The aircraft of the study {study} in flight, its aerodynamics the {learned.kind} {run_id}.",
        f"At the start in trim at Mach {flight.condition.mach:g} and {flight.condition.altitude_m:g} m.",
    )
    return exported_aircraft(level.model, level.state, learned, name or study, about)
