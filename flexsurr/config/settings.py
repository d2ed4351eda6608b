"""All configuration of one invocation: config/config.yaml, and the files it leads to, checked together."""

import os
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Self

from pydantic import Field, field_validator, model_validator

from flexsurr.config.airliner import STUDY as AIRLINER
from flexsurr.config.airliner import AirlinerFiles
from flexsurr.config.errors import ConfigurationError
from flexsurr.config.load import check_load
from flexsurr.config.merging import Source, build, merge
from flexsurr.config.reading import read_yaml
from flexsurr.config.schema import Record
from flexsurr.config.structure import Structure
from flexsurr.config.study import Count, Study
from flexsurr.config.sweep import Sweep

STUDIES = "config/studies"

STORES = ("http", "https", "sqlite", "postgresql", "mysql", "mssql")
"""Kinds of stores of runs: the scheme of an address, which may name a driver too (`mysql+pymysql`)."""


class Tracking(Record):
    """Where runs are recorded for the page on which they are compared."""

    uri: str | None = None

    @field_validator("uri")
    @classmethod
    def _is_an_address(cls, uri: str | None) -> str | None:
        scheme, separator, rest = (uri or "sqlite:///-").partition("://")
        if scheme.partition("+")[0] not in STORES or not separator or not rest:
            allowed = ", ".join(f"{store}://…" for store in STORES)
            raise ValueError(f"no address of a store; allowed: {allowed}, or nothing")
        return uri


class Timing(Record):
    """How jobs that measure time run: cores they keep others off (all when none are given)."""

    cores: Count | None = None


class Settings(Record):
    """config/config.yaml. `overrides` holds values that replace those of a study's file.

    `results` may begin with ~ and hold variables of the environment. Without an `airliner` nothing of it is
    run.
    """

    results: Annotated[str, Field(min_length=1)] = "results"
    studies: Annotated[tuple[str, ...], Field(min_length=1)]
    tracking: Tracking = Tracking()
    timing: Timing = Timing()
    overrides: dict[str, dict[str, Any]] = Field(default_factory=dict)
    airliner: AirlinerFiles | None = None

    @field_validator("results")
    @classmethod
    def _is_a_folder(cls, results: str) -> str:
        """The path with ~ and variables replaced. Braces would be wildcards in the rules, and - an option."""
        path = os.path.normpath(os.path.expanduser(os.path.expandvars(results)))
        if set(path) & set("{}$\n") or path.startswith(("-", "~")):
            raise ValueError("no folder; allowed: a path without braces, ~user or unknown $VARIABLE")
        if path == os.curdir:
            raise ValueError("the project's own folder; allowed: one below it, or elsewhere")
        return path

    @field_validator("studies")
    @classmethod
    def _have_names(cls, studies: tuple[str, ...]) -> tuple[str, ...]:
        for name in studies:
            if not re.fullmatch(r"[A-Za-z0-9_][A-Za-z0-9_-]*", name):
                raise ValueError(f"{name!r} is no name; allowed: letters, digits, underscores and hyphens")
        if len(set(studies)) != len(studies):
            raise ValueError("each at most once")
        return studies

    @model_validator(mode="after")
    def _names_are_free(self) -> Self:
        if self.airliner is not None and AIRLINER in self.studies:
            raise ValueError(f"studies: {AIRLINER!r} is what the airliner is called; another name is needed")
        return self


@dataclass(frozen=True)
class ResolvedStudy:
    """A study with everything its file refers to, and where its sweeps came from."""

    name: str
    study: Study
    structure: Structure
    sweeps: Mapping[str, Sweep]
    frequencies_also_of: tuple[Structure, ...] = ()


@dataclass(frozen=True)
class Configuration:
    """Everything that configuration files say, checked."""

    settings: Settings
    studies: tuple[ResolvedStudy, ...]


def load(root: Path, files: Sequence[str], effective: Mapping[str, Any] | None = None) -> Configuration:
    """Read and check `files` (later ones on top) below the folder `root`, and all they lead to.

    `effective` is the merged result where somebody else has merged already and may have added values
    of a command line. Raises ConfigurationError with every problem found.
    """
    sources = [Source(file, read_yaml(root / file, file)) for file in files]
    if effective is not None:
        known: dict[str, Any] = {}
        for source in sources:
            known = merge(known, source.values)
        if added := _difference(effective, known):
            sources.append(Source("--config", added))
    settings = build(Settings, sources)
    problems: list[str] = []
    if unusable := _unusable(root / settings.results):
        problems.append(f"{_holder(sources, ('results',))}: results: {settings.results!r} {unusable}")
    studies = []
    for name in settings.studies:
        try:
            studies.append(_load_study(root, name, sources))
        except ConfigurationError as error:
            problems += error.problems
    for name in settings.overrides:
        if not (root / STUDIES / f"{name}.yaml").is_file():
            problems.append(
                f"{_holder(sources, ('overrides', name))}: overrides.{name}: no such study; "
                f"allowed: {_study_names(root)}"
            )
    if problems:
        raise ConfigurationError(dict.fromkeys(problems))
    return Configuration(settings, tuple(studies))


def _unusable(folder: Path) -> str:
    """Why nothing can be written below `folder`, or nothing."""
    there = next(path for path in (folder, *folder.parents) if path.exists())
    if not there.is_dir():
        return f"is no folder: {there} is a file"
    return "" if os.access(there, os.W_OK | os.X_OK) else f"is out of reach: {there} may not be written to"


def _load_study(root: Path, name: str, sources: Sequence[Source]) -> ResolvedStudy:
    file = f"{STUDIES}/{name}.yaml"
    if not (root / file).is_file():
        raise ConfigurationError(
            [f"{_holder(sources, ('studies',))}: studies: {name!r} is unknown; allowed: {_study_names(root)}"]
        )
    study_sources = _study_files(root, file)
    for source in sources:
        values = source.values.get("overrides")
        if isinstance(values, Mapping) and isinstance(values.get(name), Mapping):
            study_sources.append(Source(source.file, values[name], ("overrides", name)))
    study = build(Study, study_sources)

    def read(key: tuple[str, ...], path: str) -> dict[str, Any]:
        if not (root / path).is_file():
            raise ConfigurationError(
                [f"{_holder(study_sources, key)}: {'.'.join(key)}: {path!r} is no file; allowed: a YAML file"]
            )
        return read_yaml(root / path, path)

    problems: list[str] = []
    structures: list[Structure] = []
    sweeps: dict[str, Sweep] = {}
    for key, path in (
        ("structure", study.structure),
        *(("frequencies_also_of", p) for p in study.frequencies_also_of),
    ):
        try:
            structures.append(build(Structure, [Source(path, read((key,), path))]))
        except ConfigurationError as error:
            problems += error.problems
    for sweep, path in study.sweeps.items():
        try:
            sweeps[sweep] = build(Sweep, [Source(path, read(("sweeps", sweep), path))])
        except ConfigurationError as error:
            problems += error.problems
    if problems:
        raise ConfigurationError(problems)
    structure, *others = structures
    modes, most = study.reduction.modes, structure.coordinates
    if modes > most:
        holder = _holder(study_sources, ("reduction", "modes"))
        raise ConfigurationError(
            [
                f"{holder}: reduction.modes: {modes} is not allowed; allowed: 1 to {most}, "
                f"the coordinates of {study.structure}"
            ]
        )
    try:
        check_load(study.evaluation.load, structure)
    except ValueError as error:
        holder = _holder(study_sources, ("evaluation", "load"))
        raise ConfigurationError([f"{holder}: evaluation.load: {error}"]) from None
    return ResolvedStudy(name, study, structure, sweeps, tuple(others))


def _study_files(root: Path, file: str) -> list[Source]:
    """The file of a study, on top of the one of the study that it is `based_on`, if any."""
    values = dict(read_yaml(root / file, file))
    base = values.pop("based_on", None)
    if base is None:
        return [Source(file, values)]
    below = f"{STUDIES}/{base}.yaml"
    if not (root / below).is_file() or below == file:
        raise ConfigurationError(
            [f"{file}: based_on: {base!r} is no other study; allowed: {_study_names(root)}"]
        )
    under = read_yaml(root / below, below)
    if "based_on" in under:
        raise ConfigurationError(
            [f"{file}: based_on: {base!r} is based on another itself; allowed: a study that is not"]
        )
    return [Source(below, under), Source(file, values)]


def _holder(sources: Sequence[Source], key: Sequence[str]) -> str:
    """The last file that gives the value of `key`."""
    for source in reversed(sources):
        values: Any = source.values
        for step in key:
            values = values.get(step) if isinstance(values, Mapping) else None
        if values is not None:
            return source.file
    return sources[0].file


def _study_names(root: Path) -> str:
    return ", ".join(sorted(path.stem for path in (root / STUDIES).glob("*.yaml")))


def _difference(over: Mapping[str, Any], under: Mapping[str, Any]) -> dict[str, Any]:
    """The values of `over` that `under` has not."""
    changed: dict[str, Any] = {}
    for key, value in over.items():
        old = under.get(key)
        if isinstance(value, Mapping) and isinstance(old, Mapping):
            if difference := _difference(value, old):
                changed[key] = difference
        elif key not in under or value != old:
            changed[key] = value
    return changed
