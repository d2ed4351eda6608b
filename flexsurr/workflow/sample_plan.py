"""The jobs of a study of samples: as `plan`, exactly the values that what each makes depends on."""

import hashlib
import json
from functools import cached_property
from typing import Any, get_args

from flexsurr.config.errors import ConfigurationError
from flexsurr.config.sources import ResolvedSampleStudy
from flexsurr.config.study import DEFAULT
from flexsurr.config.trial import LatticeForm, Map, Sampling, Trial, sample_name
from flexsurr.training.sweep import expand, run_id

Job = dict[str, Any]

_DRAWN = {
    sample_name(sampling, lattice): {"sampling": sampling, "lattice": lattice}
    for sampling in get_args(Sampling)
    for lattice in get_args(LatticeForm)
}
"""How the samples of each name are drawn."""

EVALUATED = (
    "accuracy",
    "errors",
    "modes",
    "elastic_modes",
    "left_out_modes",
    "doublets",
    "trims",
    "flights",
    "exceedances",
    "limits",
    "flight_cost",
    "cost-manoeuvre",
)
"""The names of the files that its evaluation makes."""


class SamplePlan:
    """Every job of a study of samples. Raises ConfigurationError for a sweep whose combinations don't fit."""

    def __init__(self, resolved: ResolvedSampleStudy) -> None:
        self.resolved, self.name = resolved, resolved.name
        self._trials: dict[str, list[Trial]] = {}
        problems = []
        for sweep, content in resolved.sweeps.items():
            try:
                self._trials[sweep] = expand(content)
            except ValueError as error:
                problems.append(f"{resolved.study.sweeps[sweep]}: {error}")
        if problems:
            raise ConfigurationError(problems)

    @cached_property
    def sweeps(self) -> dict[str, dict[str, Map]]:
        """The trials of each sweep by their run_id."""
        return {sweep: dict(map(self._named, trials)) for sweep, trials in self._trials.items()}

    @cached_property
    def runs(self) -> dict[str, Map]:
        """All trials by their run_id."""
        return {key: trial for trials in self.sweeps.values() for key, trial in trials.items()}

    def _named(self, trial: Trial) -> tuple[str, Map]:
        assert isinstance(trial, Map)  # as every trial of its sweeps is
        return run_id(trial, self.name, trial.dataset, self._split(trial.dataset)), trial

    @property
    def shards(self) -> int:
        """Number of shards of each set of samples."""
        return self.resolved.study.dataset.shards

    def files(self, data: str) -> list[str]:
        """The shards of the samples called `data`, below the results."""
        folder = f"datasets/{self.name}/{data}"
        return [f"{folder}/shard-{shard:04d}.parquet" for shard in range(self.shards)]

    def datasets(self) -> list[str]:
        """The names of all samples that a trial is fitted to."""
        return list(dict.fromkeys(trial.dataset for trial in self.runs.values()))

    def simulate(self, data: str, shard: int | str) -> Job:
        """One shard of the samples called `data`, by its number."""
        dataset = self.resolved.study.dataset
        first = int(shard) * dataset.samples_per_shard
        return {
            **self._samples(data),
            "study": self.name,
            "configuration": self.dataset_hash(data),
            "first": first,
            "count": min(dataset.samples_per_shard, dataset.samples - first),
        }

    def dataset_hash(self, data: str) -> str:
        """The hash of every value that the samples called `data` depend on."""
        return _hash(self._samples(data))

    def train(self, key: str) -> Job:
        """One fit."""
        trial = self.runs[key]
        return {
            "run_id": key,
            "study": self.name,
            "variant": trial.dataset,
            "dataset": DEFAULT,
            "data": self._split(trial.dataset),
            "trial": trial.model_dump(mode="json"),
            "shards": self.shards,
            **self._read(trial.dataset),
        }

    def score(self, key: str) -> Job:
        """What training says of a fit is all that there is."""
        return {"study": self.name, "run_id": key}

    def select(self) -> Job:
        """The choice among the fits."""
        sweeps = {sweep: list(trials) for sweep, trials in self.sweeps.items()}
        return {"study": self.name, "sweeps": sweeps, "maps": True}

    def accuracy(self) -> Job:
        """What the selected maps err by on the samples that each was fitted to."""
        samples = {data: self._read(data) for data in self.datasets()}
        return {"study": self.name, "shards": self.shards, "samples": samples}

    def fly(self) -> Job:
        """Aircraft, flights, and the lattice and the limits as the samples had them."""
        study = self.resolved.study
        return {
            "study": self.name,
            "aircraft": self.resolved.aircraft.model_dump(mode="json"),
            "flight": study.flight.model_dump(mode="json"),
            "limits": self.resolved.limits.model_dump(mode="json"),
            "panels": study.dataset.panels.model_dump(mode="json"),
            "boundary_condition": study.dataset.boundary_condition,
        }

    def _samples(self, data: str) -> Job:
        study, aircraft = self.resolved.study, self.resolved.aircraft
        return {
            "aircraft": aircraft.model_dump(mode="json", exclude={"structural_damping_ratio"}),
            "elastic_modes": study.flight.elastic_modes,
            "aerodynamic_modes": list(study.flight.aerodynamic_modes),
            "limits": self.resolved.limits.model_dump(mode="json"),
            "panels": study.dataset.panels.model_dump(mode="json"),
            "boundary_condition": study.dataset.boundary_condition,
            "seed": study.dataset.seed,
            **_DRAWN[data],
        }

    def _read(self, data: str) -> Job:
        """How the samples called `data` are read: whose, how many, and which of them are held out."""
        dataset = self.resolved.study.dataset
        return {
            "configuration": self.dataset_hash(data),
            "samples": dataset.samples,
            "held_out": dataset.held_out,
            "seed": dataset.seed,
        }

    def _split(self, data: str) -> str:
        return _hash(self._read(data))


def _hash(job: Job) -> str:
    return hashlib.sha256(json.dumps(job, sort_keys=True).encode()).hexdigest()[:16]
