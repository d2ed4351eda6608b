"""The jobs of a study of samples."""

from functools import cached_property
from typing import ClassVar, get_args

from flexsurr.config.sources import ResolvedSampleStudy
from flexsurr.config.study import DEFAULT
from flexsurr.config.trial import LatticeForm, Map, Sampling, Trial, sample_name
from flexsurr.report.catalogue import OF_AIRCRAFT, Product
from flexsurr.training.sweep import run_id
from flexsurr.workflow.study_plan import Job, Run, StudyPlan, digest, trials_of

_DRAWN = {
    sample_name(sampling, lattice): {"sampling": sampling, "lattice": lattice}
    for sampling in get_args(Sampling)
    for lattice in get_args(LatticeForm)
}
"""How the samples of each name are drawn."""

EVALUATION = {
    "accuracy": ["accuracy", "errors"],
    "fly": ["modes", "elastic_modes", "left_out_modes", "doublets", "trims"],
    "fly_randomly": ["flights", "exceedances", "limits", "flight_cost", "cost-manoeuvre"],
}
"""The names of the files that its evaluation makes, by the rule that makes them."""


class SamplePlan(StudyPlan):
    """Every job of a study of samples. Raises ConfigurationError for a sweep whose combinations don't fit.

    The name of samples, `data`, stands where other studies have a variant.
    """

    source = "samples"
    commands: ClassVar = {
        "simulate": "sample",
        "shards": "sample-shards",
        "train": "train-map",
        "score": "score-map",
        "trials": "map-trials",
    }

    def __init__(self, resolved: ResolvedSampleStudy) -> None:
        super().__init__(resolved.name, trials_of(resolved.sweeps, resolved.study.sweeps, {}))
        self.resolved = resolved

    @property
    def rule_of_choice(self) -> Job:
        """The study's."""
        return self.resolved.study.selection.model_dump(mode="json")

    @cached_property
    def sweeps(self) -> dict[str, dict[str, Run]]:
        """The runs of each sweep by their run_id."""
        return {sweep: dict(map(self._named, trials)) for sweep, trials in self.trials.items()}

    def _named(self, trial: Trial) -> tuple[str, Run]:
        assert isinstance(trial, Map)  # as every trial of its sweeps is
        data = trial.dataset
        return run_id(trial, self.name, data, self._split(data)), Run(self.name, data, DEFAULT, trial)

    @property
    def evaluation(self) -> dict[str, list[str]]:
        """The names of the files that its evaluation makes, by the rule that makes them."""
        return EVALUATION

    def shards(self, data: str) -> int:
        """Number of shards of the samples called `data`."""
        return self.resolved.study.dataset.shards

    def datasets(self) -> list[str]:
        """The names of all samples that a trial is fitted to."""
        return list(dict.fromkeys(run.variant for run in self.runs.values()))

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
        return digest(self._samples(data))

    def train(self, key: str) -> Job:
        """One fit."""
        run = self.runs[key]
        return {
            "run_id": key,
            "study": self.name,
            "variant": run.variant,
            "dataset": run.dataset,
            "data": self._split(run.variant),
            "trial": run.trial.model_dump(mode="json"),
            "shards": self.shards(run.variant),
            **self._read(run.variant),
        }

    def trains_on(self, key: str) -> list[str]:
        """The shards of a fit's samples, below the results."""
        return self.shard_files(self.runs[key].variant)

    def score(self, key: str) -> Job:
        """What training says of a fit, and what an evaluation takes."""
        return {"study": self.name, "run_id": key}

    def scored_on(self, key: str) -> list[str]:
        """Nothing: held-out samples have been seen to in training."""
        return []

    def select(self) -> Job:
        """The choice among the fits."""
        return {**super().select(), "maps": True}

    def values_for(self, product: Product) -> Job:
        """The aircraft too, where a figure draws it."""
        aircraft = {} if OF_AIRCRAFT.isdisjoint(product.reads) else {"aircraft": self.fly()}
        return super().values_for(product) | aircraft

    def accuracy(self) -> Job:
        """What the selected maps err by on the samples that each was fitted to."""
        samples = {data: self._read(data) for data in self.datasets()}
        return {"study": self.name, "shards": self.resolved.study.dataset.shards, "samples": samples}

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
        return digest(self._read(data))
