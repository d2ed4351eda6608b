"""The jobs of a configuration: for each rule, exactly the values that what it makes depends on.

A job is a dictionary that goes to its command in a JSON file (`job_files`). Snakemake runs a job again when
its dictionary changes, so a value that is missing here is a stale result, and a value too many is a needless
hour.
"""

import hashlib
import json
from collections.abc import Mapping
from dataclasses import dataclass
from fnmatch import fnmatch
from functools import cached_property
from typing import Any

from flexsurr.config.errors import ConfigurationError
from flexsurr.config.files import FILES
from flexsurr.config.part import values_of
from flexsurr.config.settings import Configuration
from flexsurr.config.sources import ResolvedFiles, ResolvedSampleStudy, ResolvedStudy
from flexsurr.config.study import CONFIGURATIONS, DEFAULT, Study
from flexsurr.config.trial import Architecture, Trial, configurations_of
from flexsurr.report.catalogue import FIGURES, OF_AIRCRAFT, TABLES, Product
from flexsurr.training.sweep import expand, run_id
from flexsurr.workflow.recorded import misfits, read_recorded
from flexsurr.workflow.sample_plan import EVALUATED, SamplePlan

Job = dict[str, Any]

RESPONSE_KINDS = ("free", "forced")
COMMANDS_OF_SAMPLES = {"simulate": "sample", "train": "train-map", "score": "score-map"}
"""Where a rule has a command of its own for studies of samples: each depends on its own code alone."""

DRAWN_RESPONSES = (*RESPONSE_KINDS, "sustained")

# What the trajectories of a dataset depend on, apart from the structure, the variant and their numbers.
DATASET = (
    "seed",
    "reduction",
    "dataset.duration_s",
    "dataset.step_s",
    "dataset.initial_conditions",
    "dataset.integrator",
)
# What configurations depend on that are sampled without a simulation.
SAMPLED = ("reduction", "dataset.initial_conditions")
SCORE = (
    "seed",
    "reduction",
    "dataset.initial_conditions",
    "evaluation.duration_s",
    "evaluation.output_step_s",
    "evaluation.long_responses",
    "evaluation.reference_integrator",
    "evaluation.judging_integrator",
)
STATICS = ("reduction", "statics")
VALIDATION = (
    "reduction",
    "variants",
    "evaluation.load",
    "evaluation.validation_duration_s",
    "evaluation.validation_integrator",
)
EVALUATION = (
    "seed",
    "reduction",
    "dataset.initial_conditions",
    "evaluation.duration_s",
    "evaluation.output_step_s",
    "evaluation.simulations",
    "evaluation.load",
    "evaluation.longest_load_s",
    "evaluation.integrators",
    "evaluation.reference_integrator",
)
RESPONSES = (*EVALUATION, "evaluation.drawing_integrator", "evaluation.energy_integrator")
LEARNED_LOAD = (
    "reduction",
    "evaluation.load",
    "evaluation.learned_load",
)
ROLLOUTS = ("rollouts.trajectories", "rollouts.integrator")
COST = (
    *EVALUATION,
    "evaluation.described_simulations",
    "evaluation.scipy_simulations",
    "evaluation.repeats",
)


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


class Plan:
    """Every job of a configuration. Raises ConfigurationError for a sweep whose combinations don't fit."""

    def __init__(self, configuration: Configuration) -> None:
        self.settings = configuration.settings
        self.studies: Mapping[str, ResolvedStudy | ResolvedFiles] = {
            study.name: study
            for study in configuration.studies
            if isinstance(study, ResolvedStudy | ResolvedFiles)
        }
        self.of_samples = {
            study.name: SamplePlan(study)
            for study in configuration.studies
            if isinstance(study, ResolvedSampleStudy)
        }
        self._trials = {name: _trials(study) for name, study in self.studies.items()}
        self._recorded = {
            study.name: read_recorded(study)
            for study in configuration.studies
            if isinstance(study, ResolvedFiles)
        }

    @cached_property
    def runs(self) -> dict[str, Run]:
        """Training runs by their run_id."""
        of_fields = {
            key: run
            for name in self.studies
            for runs in self._sweeps(name).values()
            for key, run in runs.items()
        }
        return of_fields | {
            key: Run(name, trial.dataset, DEFAULT, trial)
            for name, samples in self.of_samples.items()
            for key, trial in samples.runs.items()
        }

    def _sweeps(self, study: str) -> dict[str, dict[str, Run]]:
        """The runs of each sweep of one study by their run_id."""
        settings = self.studies[study].study
        sweeps: dict[str, dict[str, Run]] = {sweep: {} for sweep in self._trials[study]}
        for sweep, trials in self._trials[study].items():
            dataset = settings.dataset_of(sweep)
            for variant in settings.variants:
                folder = data_folder(variant, dataset)
                data, ranges = self.data_hash(study, folder), _hash(self._configurations(study, folder))
                for trial in trials:
                    key = run_id(trial, study, variant, ranges if configurations_of(trial) else data)
                    sweeps[sweep][key] = Run(study, variant, dataset, trial)
        return sweeps

    def runs_of(self, study: str) -> list[str]:
        """The run_ids of one study."""
        return [key for key, run in self.runs.items() if run.study == study]

    def variants(self, study: str) -> tuple[str, ...]:
        """The variants of one study's reference model."""
        return self.studies[study].study.variants

    def shards(self, study: str, data: str) -> int:
        """Number of shards of the dataset in the folder `data` of one study."""
        return 1 if study in self._recorded else self._settings(study, data).dataset.shards

    def sources(self, study: str) -> list[str]:
        """The user's files of one study."""
        return list(self._recorded[study].sha256)

    def ingest(self, study: str) -> Job:
        """The user's files of one study, as one shard."""
        settings = self._files(study).study
        used = settings.filter_in_use
        job: Job = {
            "study": study,
            "variant": FILES,
            "seed": settings.seed,
            "files": dict(self._recorded[study].sha256),
            "columns": settings.columns.model_dump(mode="json"),
            "filter": used and used.model_dump(mode="json"),
        }
        return {**job, "configuration": _hash(job)}

    def command(self, rule: str, study: str) -> str:
        """The command by which `rule` makes what one study needs."""
        return COMMANDS_OF_SAMPLES.get(rule, rule) if study in self.of_samples else rule

    def simulate(self, study: str, data: str, shard: int | str) -> Job:
        """One shard, by its number: trajectories, or samples, `first` to `first + count − 1`."""
        if study in self.of_samples:
            return self.of_samples[study].simulate(data, shard)
        dataset = self._settings(study, data).dataset
        first = int(shard) * dataset.trajectories_per_shard
        return {
            **self._dataset(study, data),
            "configuration": self.dataset_hash(study, data),
            "first": first,
            "count": min(dataset.trajectories_per_shard, dataset.trajectories - first),
        }

    def dataset_hash(self, study: str, data: str) -> str:
        """The hash of every value that the trajectories of a dataset depend on."""
        return _hash(self._dataset(study, data))

    def data_hash(self, study: str, data: str) -> str:
        """The hash of every value that training depends on by way of a dataset: its split too."""
        return _hash(self.manifest(study, data))

    def manifest(self, study: str, data: str) -> Job:
        """The manifest of one dataset."""
        if study in self._recorded:
            return self._manifest_of_files(study)
        settings = self._settings(study, data)
        return {
            "study": study,
            "variant": _variant(data),
            "seed": settings.seed,
            "configuration": self.dataset_hash(study, data),
            "shards": settings.dataset.shards,
            "trajectories": settings.dataset.trajectories,
            "split_by": settings.dataset.split_by,
            "training_fraction": settings.dataset.training_fraction,
        }

    def _manifest_of_files(self, study: str) -> Job:
        settings, ingest = self._files(study).study, self.ingest(study)
        return {
            **{key: ingest[key] for key in ("study", "variant", "seed", "configuration")},
            "shards": 1,
            "trajectories": self._recorded[study].trajectories,
            "split_by": settings.split_by,
            "training_fraction": settings.training_fraction,
            "origin": {
                "files": ingest["files"],
                "derivatives": "given" if settings.columns.have_derivatives else "estimated",
                "filter": ingest["filter"],
            },
        }

    def store(self) -> Job:
        """The tracking store."""
        return {"uri": self.settings.tracking.uri, "studies": list(self.settings.studies)}

    def train(self, key: str) -> Job:
        """One training run."""
        run = self.runs[key]
        if run.study in self.of_samples:
            return self.of_samples[run.study].train(key)
        values = self._configurations(run.study, run.data)
        return {
            **values,
            "run_id": key,
            "study": run.study,
            "variant": run.variant,
            "dataset": CONFIGURATIONS if configurations_of(run.trial) else run.dataset,
            "data": _hash(values) if configurations_of(run.trial) else self.data_hash(run.study, run.data),
            "trial": run.trial.model_dump(mode="json"),
        }

    def trains_on(self, key: str) -> list[str]:
        """The manifest or the shards that a run reads, below the results; none for configurations."""
        run = self.runs[key]
        if run.study in self.of_samples:
            return self.of_samples[run.study].files(run.data)
        return [] if configurations_of(run.trial) else [f"datasets/{run.study}/{run.data}/manifest.json"]

    def _configurations(self, study: str, data: str) -> Job:
        """What stands in the place of a dataset: a structure, and ranges of its configurations."""
        if study in self._recorded:
            return {}
        values = values_of(self._settings(study, data), SAMPLED)
        return {**self._part(study, ()), "part": values}

    def scored_on(self, key: str) -> list[str]:
        """The manifest on whose held-out samples a run is scored, below the results; none for a map."""
        run = self.runs[key]
        if run.study in self.of_samples:
            return []
        return [f"datasets/{run.study}/{run.variant}/manifest.json"]

    def score(self, key: str) -> Job:
        """Held-out errors and long responses of one run."""
        run = self.runs[key]
        if run.study in self._recorded:
            return {"part": values_of(self._files(run.study).study, ROLLOUTS)}
        if run.study in self.of_samples:
            return self.of_samples[run.study].score(key)
        return {**self._part(run.study, SCORE), "variant": run.variant}

    def select(self, study: str) -> Job:
        """The choice among the runs of each sweep of a study."""
        if study in self.of_samples:
            return self.of_samples[study].select()
        return {"study": study, "sweeps": {name: list(runs) for name, runs in self._sweeps(study).items()}}

    def accuracy(self, study: str) -> Job:
        """The errors of the selected maps."""
        return self.of_samples[study].accuracy()

    def fly(self, study: str) -> Job:
        """Flights of a study's aircraft."""
        return self.of_samples[study].fly()

    def statics(self, study: str) -> Job:
        """Static deflection and natural frequencies."""
        others = self._simulated(study).frequencies_also_of
        also = [structure.model_dump(mode="json") for structure in others]
        return {**self._part(study, STATICS), "frequencies_also_of": also}

    def validation(self, study: str) -> Job:
        """The reduced model against the full one."""
        return self._part(study, VALIDATION)

    def respond(self, study: str, variant: str) -> Job:
        """Responses and energies of the selected surrogates."""
        return {**self._part(study, RESPONSES), "variant": variant}

    def cost(self, study: str, variant: str, response: str) -> Job:
        """Wall times and errors of everything, under one response."""
        return {**self._part(study, COST), "study": study, "variant": variant, "response": response}

    def rollouts(self, study: str) -> Job:
        """The selected surrogates against held-out trajectories."""
        return {"study": study, "part": values_of(self._files(study).study, (*ROLLOUTS, "rollouts.drawn"))}

    def rollout_cost(self, study: str) -> Job:
        """Wall times of the same."""
        return {"study": study, "part": values_of(self._files(study).study, (*ROLLOUTS, "rollouts.repeats"))}

    def learn_load(self, study: str, variant: str) -> Job:
        """The study's load, learned from configurations of one variant."""
        return {**self._part(study, LEARNED_LOAD), "study": study, "variant": variant}

    def load_data(self, study: str, variant: str) -> str:
        """The folder of the dataset that the load is learned from, below that of the study's datasets."""
        return data_folder(variant, self._simulated(study).study.evaluation.learned_load.dataset)

    def files(self, study: str, read: str) -> list[str]:
        """The files below the results that hold what a product of flexsurr.report `read`s."""
        runs = {"metrics": "metrics.json", "history": "history.parquet"}
        if read == "structure" or read in OF_AIRCRAFT:
            return []
        if read == "relatives":
            structure = self._simulated(study).structure
            related = [
                name
                for name, other in self.studies.items()
                if isinstance(other, ResolvedStudy) and other.structure == structure
            ]
            return [file for name in related for file in self.files(name, "metrics")]
        if read in runs:
            return [f"runs/{key}/{runs[read]}" for key in self.runs_of(study)]
        found = [
            f"evaluation/{study}/{name}.parquet" for name in self._evaluated(study) if fnmatch(name, read)
        ]
        if not found:
            raise ValueError(f"no rule makes {read}")
        return found

    def _evaluated(self, study: str) -> list[str]:
        """The names of the files that the evaluation of one study makes."""
        if study in self._recorded:
            return ["rollouts", "rollout_curves", "rollout_cost"]
        if study in self.of_samples:
            return list(EVALUATED)
        variants = self.variants(study)
        names = ["statics", "frequencies", "validation"]
        names += [f"response-{variant}-{response}" for variant in variants for response in DRAWN_RESPONSES]
        names += [f"{kind}-{variant}" for kind in ("energy", "learned_loads") for variant in variants]
        return [*names, *(f"cost-{variant}-{kind}" for variant in variants for kind in RESPONSE_KINDS)]

    def figures(self, study: str) -> list[str]:
        """The figures of one study: those of its source that show a structure like its own."""
        return self._products(study, FIGURES)

    def tables(self, study: str) -> list[str]:
        """The tables of one study."""
        return self._products(study, TABLES)

    def _products(self, study: str, catalogue: Mapping[str, Product]) -> list[str]:
        if study in self.of_samples:
            return [name for name, product in catalogue.items() if "samples" in product.sources]
        resolved = self.studies[study]
        return [
            name
            for name, product in catalogue.items()
            if resolved.study.source in product.sources
            and (isinstance(resolved, ResolvedFiles) or product.shows(resolved.structure))
        ]

    def read_by(self, study: str, product: Product) -> list[str]:
        """The files below the results that a figure or table of one study reads."""
        return [file for read in product.reads for file in self.files(study, read)]

    def draw(self, study: str, figure: str) -> Job:
        """One figure."""
        return {"figure": figure, **self._reads(study, FIGURES[figure])}

    def tabulate(self, study: str, table: str) -> Job:
        """One table."""
        return {"table": table, **self._reads(study, TABLES[table])}

    def _reads(self, study: str, product: Product) -> Job:
        reads: Job = {"reads": {read: self.files(study, read) for read in product.reads}}
        if "structure" in product.reads:
            reads["structure"] = self._simulated(study).structure.model_dump(mode="json")
        if not OF_AIRCRAFT.isdisjoint(product.reads):
            reads["aircraft"] = self.fly(study)
        return reads

    def _part(self, study: str, keys: tuple[str, ...]) -> Job:
        resolved = self._simulated(study)
        structure = resolved.structure.model_dump(mode="json")
        return {"structure": structure, "part": values_of(resolved.study, keys)}

    def _dataset(self, study: str, data: str) -> Job:
        part = values_of(self._settings(study, data), DATASET)
        return {**self._part(study, ()), "part": part, "study": study, "variant": _variant(data)}

    def _settings(self, study: str, data: str) -> Study:
        """The study as if the dataset in the folder `data` were its only one."""
        settings = self._simulated(study).study
        dataset = settings.datasets[data.partition("-")[2] or DEFAULT]
        return settings.model_copy(update={"dataset": dataset, "seed": settings.seed_of(dataset)})

    def _simulated(self, study: str) -> ResolvedStudy:
        """A study of trajectories that are simulated."""
        resolved = self.studies[study]
        assert isinstance(resolved, ResolvedStudy)
        return resolved

    def _files(self, study: str) -> ResolvedFiles:
        """A study of the user's files."""
        resolved = self.studies[study]
        assert isinstance(resolved, ResolvedFiles)
        return resolved


def _hash(job: Job) -> str:
    return hashlib.sha256(json.dumps(job, sort_keys=True).encode()).hexdigest()[:16]


def _variant(data: str) -> str:
    return data.partition("-")[0]


def _trials(study: ResolvedStudy | ResolvedFiles) -> dict[str, tuple[Trial, ...]]:
    trials: dict[str, tuple[Trial, ...]] = {}
    problems = []
    for name, sweep in study.sweeps.items():
        try:
            trials[name] = tuple(expand(sweep, study.own_networks))
        except ValueError as error:
            problems.append(f"{study.study.sweeps[name]}: {' '.join(str(error).split())}")
            continue
        if isinstance(study, ResolvedFiles):
            problems += misfits(study, study.study.sweeps[name], trials[name])
    if problems:
        raise ConfigurationError(problems)
    return trials
