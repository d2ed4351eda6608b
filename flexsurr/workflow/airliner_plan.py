"""The jobs of the airliner: as `plan`, exactly the values that what each makes depends on."""

import hashlib
import json
from functools import cached_property
from typing import Any, get_args

from flexsurr.config.errors import ConfigurationError
from flexsurr.config.sources import ResolvedSampleStudy
from flexsurr.config.study import DEFAULT
from flexsurr.config.trial import LatticeForm, Map, Sampling, sample_name
from flexsurr.training.sweep import expand, run_id

Job = dict[str, Any]

_DATASETS = {
    sample_name(sampling, lattice): (sampling, lattice)
    for sampling in get_args(Sampling)
    for lattice in get_args(LatticeForm)
}


class AirlinerPlan:
    """Every job of the airliner. Raises ConfigurationError for a sweep whose combinations don't fit."""

    def __init__(self, airliner: ResolvedSampleStudy) -> None:
        self.airliner = airliner
        try:
            self._trials = expand(airliner.sweeps[DEFAULT])
        except ValueError as error:
            raise ConfigurationError([f"{airliner.study.sweeps[DEFAULT]}: {error}"]) from None

    @cached_property
    def runs(self) -> dict[str, Map]:
        """Trials by their run_id."""
        study = self.airliner.name
        runs: dict[str, Map] = {}
        for trial in self._trials:
            assert isinstance(trial, Map)  # as every trial of a MapSweep is
            data = self.configuration(trial.dataset)
            runs[f"{study}-{run_id(trial, study, trial.dataset, data)}"] = trial
        return runs

    @property
    def shards(self) -> int:
        """Number of shards of each set of samples."""
        return self.airliner.study.dataset.shards

    def sample(self, name: str, shard: int | str) -> Job:
        """One shard of the samples called `name`, by its number."""
        dataset = self.airliner.study.dataset
        first = int(shard) * dataset.samples_per_shard
        return {
            **self._samples(name),
            "study": self.airliner.name,
            "configuration": self.configuration(name),
            "first": first,
            "count": min(dataset.samples_per_shard, dataset.samples - first),
        }

    def configuration(self, name: str) -> str:
        """The hash of every value that the samples called `name` depend on."""
        canonical = json.dumps(self._samples(name), sort_keys=True)
        return hashlib.sha256(canonical.encode()).hexdigest()[:16]

    def train(self, run_id: str) -> Job:
        """One fit."""
        trial, dataset = self.runs[run_id], self.airliner.study.dataset
        return {
            "run_id": run_id,
            "study": self.airliner.name,
            "trial": trial.model_dump(mode="json"),
            "configuration": self.configuration(trial.dataset),
            "samples": dataset.samples,
            "held_out": dataset.held_out,
            "seed": dataset.seed,
        }

    def select(self) -> Job:
        """The choice among the fits."""
        return {"study": self.airliner.name, "runs": list(self.runs)}

    def _samples(self, name: str) -> Job:
        sampling, lattice = _DATASETS[name]
        dataset, flight = self.airliner.study.dataset, self.airliner.study.flight
        aircraft = self.airliner.aircraft.model_dump(mode="json", exclude={"structural_damping_ratio"})
        return {
            "aircraft": aircraft,
            "elastic_modes": flight.elastic_modes,
            "aerodynamic_modes": list(flight.aerodynamic_modes),
            "limits": self.airliner.limits.model_dump(mode="json"),
            "panels": dataset.panels.model_dump(mode="json"),
            "boundary_condition": dataset.boundary_condition,
            "seed": dataset.seed,
            "sampling": sampling,
            "lattice": lattice,
        }
