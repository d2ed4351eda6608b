"""What the plans of all studies share: their runs, and how jobs are made of values.

A job is a dictionary that goes to its command in a JSON file (`job_files`). Snakemake runs a job again when
its dictionary changes, so a value that is missing is a stale result, and a value too many is a needless
hour.
"""

import hashlib
import json
from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any, ClassVar

from flexsurr.config.errors import ConfigurationError
from flexsurr.config.study import CONFIGURATIONS, DEFAULT
from flexsurr.config.sweep import Sweep
from flexsurr.config.trial import Architecture, Trial, configurations_of
from flexsurr.report.catalogue import Product
from flexsurr.training.sweep import expand, run_id

Job = dict[str, Any]


@dataclass(frozen=True)
class Run:
    """One training run: a trial of a sweep on a dataset of one variant, or in its place."""

    study: str
    variant: str
    dataset: str
    trial: Architecture

    @property
    def data(self) -> str:
        """The folder of the data, below that of the study's datasets."""
        return data_folder(self.variant, self.dataset)


def data_folder(variant: str, dataset: str) -> str:
    """The folder of one dataset of one variant: the variant's name, and that of a further dataset."""
    return variant if dataset == DEFAULT else f"{variant}-{dataset}"


def digest(job: Job) -> str:
    """Sixteen hex digits of the hash of a job."""
    return hashlib.sha256(json.dumps(job, sort_keys=True).encode()).hexdigest()[:16]


def trials_of(
    sweeps: Mapping[str, Sweep], files: Mapping[str, str], own_networks: Mapping[str, str]
) -> dict[str, list[Trial]]:
    """The trials of each sweep. Raises ConfigurationError, by its file, for one that makes none."""
    trials, problems = {}, []
    for name, sweep in sweeps.items():
        try:
            trials[name] = expand(sweep, own_networks)
        except ValueError as error:
            problems.append(f"{files[name]}: {' '.join(str(error).split())}")
    if problems:
        raise ConfigurationError(problems)
    return trials


class StudyPlan(ABC):
    """The jobs of one study: a method of the name of each rule takes what follows the study in its wildcards.

    `commands` are those by which rules make what only such a study has; every other command is called as
    its rule. Each then depends on its own code alone.
    """

    source: ClassVar[str]
    commands: ClassVar[Mapping[str, str]] = {}

    def __init__(self, name: str, trials: Mapping[str, list[Trial]]) -> None:
        self.name, self.trials = name, trials

    @cached_property
    @abstractmethod
    def sweeps(self) -> dict[str, dict[str, Run]]:
        """The runs of each sweep by their run_id."""

    @cached_property
    def runs(self) -> dict[str, Run]:
        """All runs by their run_id."""
        return {key: run for runs in self.sweeps.values() for key, run in runs.items()}

    @property
    @abstractmethod
    def evaluation(self) -> dict[str, list[str]]:
        """The names of the files that its evaluation makes, by the rule that makes them."""

    @property
    def rule_of_choice(self) -> Job:
        """The rule by which runs are chosen, if it has settings."""
        return {}

    @abstractmethod
    def shards(self, data: str) -> int:
        """Number of shards of the data in the folder `data`."""

    @abstractmethod
    def train(self, key: str) -> Job:
        """One training run."""

    @abstractmethod
    def trains_on(self, key: str) -> list[str]:
        """The files that a run reads, below the results."""

    @abstractmethod
    def score(self, key: str) -> Job:
        """The scores of one run."""

    @abstractmethod
    def scored_on(self, key: str) -> list[str]:
        """The files that a run is scored on, below the results."""

    def shard_file(self, data: str, number: int) -> str:
        """One shard of the data in the folder `data`, below the results."""
        return f"datasets/{self.name}/{data}/shard-{number:04d}.parquet"

    def shard_files(self, data: str) -> list[str]:
        """All of them."""
        return [self.shard_file(data, number) for number in range(self.shards(data))]

    def command(self, rule: str) -> str:
        """The command by which `rule` makes what this study needs."""
        return self.commands.get(rule, rule)

    def select(self) -> Job:
        """The choice among the runs of each sweep, and its rule."""
        sweeps = {sweep: list(runs) for sweep, runs in self.sweeps.items()}
        return {"study": self.name, "sweeps": sweeps, "selection": self.rule_of_choice}

    def shows(self, product: Product) -> bool:
        """Whether a figure or table is made of this study."""
        return self.source in product.sources

    def values_for(self, product: Product) -> Job:
        """What a figure or table needs besides files: of the choice among runs, what it shows."""
        choice = self.select()
        return {read: choice[read] for read in ("sweeps", "selection") if read in product.reads}


class FieldPlan(StudyPlan):
    """The jobs of a study that learns fields from trajectories, simulated or recorded."""

    variants: tuple[str, ...]

    @abstractmethod
    def dataset_of(self, sweep: str) -> str:
        """The name of the dataset that a sweep trains on."""

    @abstractmethod
    def manifest(self, data: str) -> Job:
        """The manifest of the dataset in the folder `data`."""

    def configurations(self, data: str) -> Job:
        """What stands in the place of a dataset, if anything does."""
        return {}

    def ranges(self, data: str) -> str:
        """A hash of it."""
        return digest(self.configurations(data))

    @cached_property
    def sweeps(self) -> dict[str, dict[str, Run]]:
        """The runs of each sweep by their run_id."""
        sweeps: dict[str, dict[str, Run]] = {sweep: {} for sweep in self.trials}
        for sweep, trials in self.trials.items():
            dataset = self.dataset_of(sweep)
            for variant in self.variants:
                folder = data_folder(variant, dataset)
                data, ranges = digest(self.manifest(folder)), self.ranges(folder)
                for trial in trials:
                    key = run_id(trial, self.name, variant, ranges if configurations_of(trial) else data)
                    sweeps[sweep][key] = Run(self.name, variant, dataset, trial)
        return sweeps

    def train(self, key: str) -> Job:
        """One training run."""
        run = self.runs[key]
        values, sampled = self.configurations(run.data), configurations_of(run.trial)
        return {
            **values,
            "run_id": key,
            "study": self.name,
            "variant": run.variant,
            "dataset": CONFIGURATIONS if sampled else run.dataset,
            "data": self.ranges(run.data) if sampled else digest(self.manifest(run.data)),
            "trial": run.trial.model_dump(mode="json"),
        }

    def trains_on(self, key: str) -> list[str]:
        """The manifest of a run's dataset, below the results; none for configurations."""
        run = self.runs[key]
        return [] if configurations_of(run.trial) else [self._manifest_file(run.data)]

    def scored_on(self, key: str) -> list[str]:
        """The manifest on whose held-out samples a run is scored, below the results."""
        return [self._manifest_file(self.runs[key].variant)]

    def _manifest_file(self, data: str) -> str:
        return f"datasets/{self.name}/{data}/manifest.json"
