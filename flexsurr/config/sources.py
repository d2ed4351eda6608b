"""The sources a study's data come from: for each, what its file holds, and how what it names is read."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from flexsurr.config.aerodynamics import FeatureLimits
from flexsurr.config.aircraft import SURFACES, Aircraft
from flexsurr.config.files import FilesStudy
from flexsurr.config.flight import CONTROL_NAMES
from flexsurr.config.modes_study import ModesStudy
from flexsurr.config.own_network import own_network
from flexsurr.config.sample_study import SampleStudy
from flexsurr.config.structure import Structure
from flexsurr.config.study import DEFAULT, Study
from flexsurr.config.study_files import StudyFiles
from flexsurr.config.sweep import FieldSweep, MapSweep, Sweep


@dataclass(frozen=True)
class ResolvedStudy:
    """A study of trajectories with everything its file refers to.

    `own_networks` has the hash of the file of each architecture of the user's own.
    """

    name: str
    study: Study
    structure: Structure
    sweeps: Mapping[str, Sweep]
    frequencies_also_of: tuple[Structure, ...] = ()
    own_networks: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True)
class ResolvedSampleStudy:
    """A study of samples with everything its file refers to."""

    name: str
    study: SampleStudy
    aircraft: Aircraft
    limits: FeatureLimits
    sweeps: Mapping[str, Sweep]


@dataclass(frozen=True)
class ResolvedFiles:
    """A study of the user's own files, which lie below `root`, with its sweeps."""

    name: str
    study: FilesStudy
    sweeps: Mapping[str, Sweep]
    own_networks: Mapping[str, str]
    root: Path


@dataclass(frozen=True)
class ResolvedModesStudy:
    """A study of several numbers of modes with everything its file refers to."""

    name: str
    study: ModesStudy
    structure: Structure
    sweeps: Mapping[str, Sweep]
    own_networks: Mapping[str, str]

    def of(self, modes: int) -> ResolvedStudy:
        """The study of trajectories that one number of modes makes."""
        study = self.study.of(modes)
        sweeps = {name: self.sweeps[name] for name in study.sweeps}
        return ResolvedStudy(self.name, study, self.structure, sweeps, own_networks=self.own_networks)


AnyStudy = ResolvedStudy | ResolvedSampleStudy | ResolvedFiles | ResolvedModesStudy


def _trajectories(files: StudyFiles) -> ResolvedStudy:
    study = files.record(Study)
    structure = files.named(Structure, study.structure, "structure")
    others = [files.named(Structure, path, "frequencies_also_of") for path in study.frequencies_also_of]
    sweeps, own_networks = _field_sweeps(files, study.sweeps)
    _check_modes(files, study.reduction.modes, structure, study.structure, "reduction", "modes")
    try:
        study.evaluation.load.check(structure)
        load = study.evaluation.load.with_tables(files.root)
    except ValueError as error:
        files.refuse(str(error), "evaluation", "load")
    evaluation = study.evaluation.model_copy(update={"load": load})
    study = study.model_copy(update={"evaluation": evaluation})
    return ResolvedStudy(files.name, study, structure, sweeps, tuple(others), own_networks)


def _check_modes(files: StudyFiles, modes: int, structure: Structure, path: str, *key: str) -> None:
    most = structure.coordinates
    if modes > most:
        files.refuse(f"{modes} is not allowed; allowed: 1 to {most}, the coordinates of {path}", *key)


def _modes(files: StudyFiles) -> ResolvedModesStudy:
    study = files.record(ModesStudy)
    structure = files.named(Structure, study.structure, "structure")
    sweeps, own_networks = _field_sweeps(files, study.sweeps)
    _check_modes(files, max(study.modes), structure, study.structure, "modes")
    for name, sweep in sweeps.items():
        if any(("configurations",) not in space.dimensions() for space in sweep.spaces):
            files.refuse(f"{study.sweeps[name]!r} has a space without configurations", "sweeps", name)
    return ResolvedModesStudy(files.name, study, structure, sweeps, own_networks)


def _samples(files: StudyFiles) -> ResolvedSampleStudy:
    study = files.record(SampleStudy)
    aircraft = files.named(Aircraft, study.aircraft, "aircraft")
    limits = files.named(FeatureLimits, study.limits, "limits")
    sweeps = {name: files.named(MapSweep, path, "sweeps", name) for name, path in study.sweeps.items()}
    files.check()
    if all(space.architecture != "network" for space in sweeps[DEFAULT].spaces):
        problem = f"{study.sweeps[DEFAULT]!r} has no space of a network; one is needed to fly with"
        files.refuse(problem, "sweeps", DEFAULT)
    for surface in SURFACES:
        strips, least = getattr(study.dataset.panels, surface)[0], aircraft.parts_of_span(surface)
        if strips < least:
            problem = f"{strips} strips for {least} parts of the span; allowed: at least one each"
            files.refuse(problem, "dataset", "panels", surface)
    for control in CONTROL_NAMES:
        least_deg, most_deg = study.flight.random_flights.least_deg, limits.deflection_deg(control)
        if not least_deg < most_deg:
            problem = f"{least_deg:g} is not allowed; allowed: below {most_deg:g}, the {control}'s limit"
            files.refuse(problem, "flight", "random_flights", "least_deg")
    return ResolvedSampleStudy(files.name, study, aircraft, limits, sweeps)


def _files(files: StudyFiles) -> ResolvedFiles:
    study = files.record(FilesStudy)
    return ResolvedFiles(files.name, study, *_field_sweeps(files, study.sweeps), files.root)


def _field_sweeps(files: StudyFiles, paths: Mapping[str, str]) -> tuple[dict[str, Sweep], dict[str, str]]:
    """The sweeps in these files, and the hash of the file of each architecture of the user's own.

    Raises ConfigurationError with every problem of what the study names.
    """
    sweeps: dict[str, Sweep] = {
        name: files.named(FieldSweep, path, "sweeps", name) for name, path in paths.items()
    }
    files.check()
    own_networks: dict[str, str] = {}
    for name, path in paths.items():
        for number, space in enumerate(sweeps[name].spaces):
            if network := own_network(space.architecture):
                key = f"{path}: spaces[{number}].architecture"
                own_networks[space.architecture] = files.hash_of(network, key)
    files.check()
    return sweeps, own_networks


SOURCES: dict[str, Callable[[StudyFiles], AnyStudy]] = {
    "trajectories": _trajectories,
    "samples": _samples,
    "files": _files,
    "modes": _modes,
}
"""What a study's `source` may be; without one it is "trajectories"."""


def resolve(files: StudyFiles) -> AnyStudy:
    """The study in `files` and all it leads to, checked. Raises ConfigurationError with what is wrong."""
    source = files.value("source", "trajectories")
    if not isinstance(source, str) or source not in SOURCES:
        files.refuse(f"{source!r} is not allowed; allowed: {', '.join(SOURCES)}", "source")
    return SOURCES[source](files)
