"""The jobs of a study of the user's own files, which are read and checked before any job."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from flexsurr.config.errors import ConfigurationError
from flexsurr.config.files import FILES
from flexsurr.config.schema import values_of
from flexsurr.config.sources import ResolvedFiles
from flexsurr.config.study_files import STUDIES
from flexsurr.config.trial import FieldNetwork, Trial, configurations_of
from flexsurr.storage import StorageError
from flexsurr.storage.source_files import find_files, read_recordings
from flexsurr.workflow.study_plan import FieldPlan, Job, digest, trials_of

ROLLOUTS = ("rollouts.trajectories", "rollouts.integrator")

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


def misfits(resolved: ResolvedFiles, sweep: str, trials: Sequence[Trial]) -> list[str]:
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


class FilesPlan(FieldPlan):
    """Every job of such a study. Raises ConfigurationError for files or trials that do not fit it."""

    source = "files"

    def __init__(self, resolved: ResolvedFiles) -> None:
        study = resolved.study
        super().__init__(resolved.name, trials_of(resolved.sweeps, study.sweeps, resolved.own_networks))
        problems = [
            line
            for sweep, trials in self.trials.items()
            for line in misfits(resolved, study.sweeps[sweep], trials)
        ]
        if problems:
            raise ConfigurationError(problems)
        self.resolved, self.variants = resolved, study.variants
        self._recorded = read_recorded(resolved)

    def dataset_of(self, sweep: str) -> str:
        """The name of the dataset that a sweep trains on."""
        return self.resolved.study.dataset_of(sweep)

    @property
    def rule_of_choice(self) -> Job:
        """The study's."""
        return self.resolved.study.selection.model_dump(mode="json")

    @property
    def sources(self) -> list[str]:
        """The user's files."""
        return list(self._recorded.sha256)

    def shards(self, data: str) -> int:
        """Number of shards: all files make one."""
        return 1

    def ingest(self) -> Job:
        """The user's files, as one shard."""
        study = self.resolved.study
        used = study.filter_in_use
        job: Job = {
            "study": self.name,
            "variant": FILES,
            "seed": study.seed,
            "files": dict(self._recorded.sha256),
            "columns": study.columns.model_dump(mode="json"),
            "filter": used and used.model_dump(mode="json"),
        }
        return {**job, "configuration": digest(job)}

    def manifest(self, data: str) -> Job:
        """The manifest of the dataset, with where its data come from."""
        study, ingest = self.resolved.study, self.ingest()
        return {
            **{key: ingest[key] for key in ("study", "variant", "seed", "configuration")},
            "shards": self.shards(data),
            "trajectories": self._recorded.trajectories,
            "split_by": study.split_by,
            "training_fraction": study.training_fraction,
            "origin": {
                "files": ingest["files"],
                "derivatives": "given" if study.columns.have_derivatives else "estimated",
                "filter": ingest["filter"],
            },
        }

    def score(self, key: str) -> Job:
        """Held-out errors and rollouts of one run."""
        return {"part": values_of(self.resolved.study, ROLLOUTS)}

    def rollouts(self) -> Job:
        """The selected surrogates against held-out trajectories."""
        return {"study": self.name, "part": values_of(self.resolved.study, (*ROLLOUTS, "rollouts.drawn"))}

    def rollout_cost(self) -> Job:
        """Wall times of the same."""
        return {"study": self.name, "part": values_of(self.resolved.study, (*ROLLOUTS, "rollouts.repeats"))}

    @property
    def evaluation(self) -> dict[str, list[str]]:
        """The names of the files that its evaluation makes, by the rule that makes them."""
        return {"rollouts": ["rollouts", "rollout_curves"], "rollout_cost": ["rollout_cost"]}
