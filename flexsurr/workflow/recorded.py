"""The files of a study of the user's own data, read and checked before any job."""

from collections.abc import Mapping
from dataclasses import dataclass

from flexsurr.config.errors import ConfigurationError
from flexsurr.config.sources import ResolvedFiles
from flexsurr.config.study_files import STUDIES
from flexsurr.config.trial import FieldNetwork, Trial, configurations_of
from flexsurr.storage import StorageError
from flexsurr.storage.source_files import find_files, read_recordings

PAIRLESS = ("mlp",)
"""Architectures whose states need not be pairs (q, p)."""


@dataclass(frozen=True)
class Recorded:
    """What a study's files hold: the SHA-256 of each, and the number of all trajectories."""

    sha256: Mapping[str, str]
    trajectories: int


def read_recorded(resolved: ResolvedFiles) -> Recorded:
    """Every file of a study, read whole. Raises ConfigurationError with a line for each that is not right."""
    study, holder = resolved.study, f"{STUDIES}/{resolved.name}.yaml"
    by = study.filter_in_use
    try:
        files = find_files(resolved.root, study.files)
        found = read_recordings(resolved.root, files, study.columns, 2 if by is None else by.window)
    except StorageError as error:
        raise ConfigurationError([f"{holder}: files: {line}" for line in str(error).splitlines()]) from None
    count = len(found.trajectories)
    if count < 2 and study.split_by == "trajectory":
        raise ConfigurationError(
            [f"{holder}: files: hold one trajectory; allowed: two or more, or split_by: sample"]
        )
    return Recorded(found.sha256, count)


def misfits(resolved: ResolvedFiles, sweep: str, trials: tuple[Trial, ...]) -> list[str]:
    """A line for each way in which trials of a sweep do not fit a study of files.

    There is no structure whose configurations could be sampled, and its states may be no pairs (q, p).
    """
    holder = f"{STUDIES}/{resolved.name}.yaml"
    states = f"columns.states of {holder}, which are no pairs of q and p"
    paired = bool(resolved.study.columns.pairs)
    problems: dict[str, None] = {}
    for trial in trials:
        if configurations_of(trial):
            problem = f"configurations: {holder} has no structure to sample; allowed: to leave it out"
        elif not paired and trial.architecture not in PAIRLESS:
            allowed = f"{', '.join(PAIRLESS)}, or columns.pairs"
            problem = f"architecture: {trial.architecture!r} is not allowed for {states}; allowed: {allowed}"
        elif not paired and isinstance(trial, FieldNetwork) and trial.scaling == "canonical":
            problem = f"scaling: 'canonical' is not allowed for {states}; allowed: per_feature, min_max"
        else:
            continue
        problems[f"{sweep}: {problem}"] = None
    return list(problems)
