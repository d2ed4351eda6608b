"""All configuration of one invocation: config/config.yaml, and the files it leads to, checked together."""

import os
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

from pydantic import Field, field_validator

from flexsurr.config.errors import ConfigurationError
from flexsurr.config.reading import Source, build, merge, read_yaml
from flexsurr.config.schema import Record, check_once
from flexsurr.config.sources import AnyStudy, resolve
from flexsurr.config.study import Count
from flexsurr.config.study_files import STUDIES, StudyFiles, holder, known_studies

STORES = ("http", "https", "sqlite", "postgresql", "mysql", "mssql")
"""Kinds of stores of runs: the scheme of an address, which may name a driver too (`mysql+pymysql`)."""

RULES = re.compile(
    "accuracy|all|answer|draw_.+|evaluate|fly|fly_randomly|fly_references|ingest|join|learn_load|manifest|"
    "rehearse|responses|rivals|rollout_cost|rollouts|score|select|shards|simulate|statics|tabulate_.+|train|"
    "trials|validation|watch"
)
"""The rules of the Snakefile: no study can have such a name, by which it would be a target itself."""


def check_name(name: str) -> None:
    """ValueError for what cannot be the name of a study."""
    if not re.fullmatch(r"[A-Za-z0-9_][A-Za-z0-9_-]*", name):
        raise ValueError(f"{name!r} is no name; allowed: letters, digits, underscores and hyphens")
    if RULES.fullmatch(name):
        raise ValueError(f"{name!r} is the name of a rule; allowed: any other")


def check_address(uri: str) -> None:
    """ValueError for what cannot be the address of a store of runs."""
    scheme, _, rest = uri.partition("://")
    if scheme.partition("+")[0] not in STORES or not rest:
        allowed = ", ".join(f"{store}://…" for store in STORES)
        raise ValueError(f"no address of a store; allowed: {allowed}, or nothing")


class Tracking(Record):
    """Where runs are recorded for the page on which they are compared."""

    uri: str | None = None
    """Address of a store or server of MLflow. None: a database of its own in `<results>/mlflow`."""

    @field_validator("uri")
    @classmethod
    def _is_an_address(cls, uri: str | None) -> str | None:
        if uri:
            check_address(uri)
        return uri


class Timing(Record):
    """How jobs that measure time run."""

    cores: Count | None = None
    """Cores that a job which measures time keeps others off. None: all, so that it runs alone."""


class Batches(Record):
    """How much small work one job does, one after another."""

    trials_per_job: Count | None = None
    """Trials of fields, each with its score. None: a job each up to 200 of a study. Never over 128 jobs."""
    maps_per_job: Count | None = None
    """The same of maps, the trials of a study of samples: they take minutes where others take seconds."""
    shards_per_job: Count | None = None
    """Shards of a dataset. None: a job each up to 200. Never over 128 jobs."""


class Settings(Record):
    """What one invocation is to do."""

    results: Annotated[str, Field(min_length=1)] = "results"
    """The folder that everything is written to; it may begin with ~ and hold variables of the environment."""
    studies: Annotated[tuple[str, ...], Field(min_length=1)]
    """The studies to run: names of files in config/studies."""
    tracking: Tracking = Tracking()
    """Where runs are recorded, for the page on which they are compared."""
    timing: Timing = Timing()
    """How time is measured."""
    batches: Batches = Batches()
    """How much small work one job does."""
    overrides: dict[str, dict[str, Any]] = Field(default_factory=dict)
    """For a study's name, values that replace those of its file, nested as they are there."""

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
            check_name(name)
        check_once(studies)
        return studies


@dataclass(frozen=True)
class Configuration:
    """Everything that configuration files say, checked."""

    settings: Settings
    studies: tuple[AnyStudy, ...]


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
        problems.append(f"{holder(sources, ('results',))}: results: {settings.results!r} {unusable}")
    found = []
    for name in settings.studies:
        try:
            found.append(resolve(StudyFiles(root, name, sources)))
        except ConfigurationError as error:
            problems += error.problems
    for name in settings.overrides:
        if not (root / STUDIES / f"{name}.yaml").is_file():
            problems.append(
                f"{holder(sources, ('overrides', name))}: overrides.{name}: no such study; "
                f"allowed: {known_studies(root)}"
            )
    if problems:
        raise ConfigurationError(dict.fromkeys(problems))
    return Configuration(settings, tuple(found))


def _unusable(folder: Path) -> str:
    """Why nothing can be written below `folder`, or nothing."""
    there = next(path for path in (folder, *folder.parents) if path.exists())
    if not there.is_dir():
        return f"is no folder: {there} is a file"
    return "" if os.access(there, os.W_OK | os.X_OK) else f"is out of reach: {there} may not be written to"


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
