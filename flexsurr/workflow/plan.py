"""The plan of a configuration: a plan for each of its studies, and the figures and tables of all."""

import re
from collections.abc import Iterable, Mapping
from fnmatch import fnmatch
from functools import cached_property
from pathlib import Path

from flexsurr.config.errors import ConfigurationError
from flexsurr.config.load import turns_clamp
from flexsurr.config.settings import Configuration
from flexsurr.config.sources import AnyStudy, ResolvedModesStudy, ResolvedSampleStudy, ResolvedStudy
from flexsurr.report.catalogue import FIGURES, OF_AIRCRAFT, TABLES, Product
from flexsurr.workflow.batches import batch_of_shard, batches_of_runs, shards_of_batch
from flexsurr.workflow.files_plan import FilesPlan
from flexsurr.workflow.modes_plan import ModesPlan
from flexsurr.workflow.sample_plan import SamplePlan
from flexsurr.workflow.study_plan import Job, Run
from flexsurr.workflow.trajectory_plan import TrajectoryPlan

AnyPlan = TrajectoryPlan | FilesPlan | SamplePlan | ModesPlan

FIT = "fit.json"
"""The file of a run that says that it has been trained."""

OF_RUNS = {"metrics": "metrics.json", "history": "history.parquet"}
"""The file of each run that a figure or table reads."""


def _plan_of(study: AnyStudy) -> AnyPlan:
    match study:
        case ResolvedStudy() | ResolvedModesStudy():
            if not study.structure.plain:
                _check(study)
            if isinstance(study, ResolvedModesStudy):
                return ModesPlan(study)
            if turns_clamp(study.study.evaluation.load):
                _check_load(study)
            return TrajectoryPlan(study)
        case ResolvedSampleStudy():
            return SamplePlan(study)
    return FilesPlan(study)


def _check(study: ResolvedStudy | ResolvedModesStudy) -> None:
    # imported here, for the beam brings SciPy and numba, which a plan does not need
    from flexsurr.beam.soundness import check_structure

    try:
        check_structure(study.structure)
    except ValueError as error:
        raise ConfigurationError([f"{study.study.structure}: {error}"]) from None


def _check_load(study: ResolvedStudy) -> None:
    from flexsurr.beam.soundness import check_load  # likewise

    try:
        check_load(study.structure, study.study.evaluation.load)
    except ValueError as error:
        raise ConfigurationError([f"{study.name}: evaluation.load: {error}"]) from None


class Plan:
    """Every job of a configuration.

    Raises ConfigurationError for a sweep whose combinations don't fit, and for a structure that cannot move.
    """

    def __init__(self, configuration: Configuration) -> None:
        self.settings = configuration.settings
        self.studies: Mapping[str, AnyPlan] = {study.name: _plan_of(study) for study in configuration.studies}

    @cached_property
    def runs(self) -> dict[str, Run]:
        """The training runs of all studies by their run_id."""
        return {key: run for study in self.studies.values() for key, run in study.runs.items()}

    def study_of(self, key: str) -> AnyPlan:
        """The plan of the study that a run is of."""
        return self.studies[self.runs[key].study]

    def of_source(self, source: str) -> list[str]:
        """The names of the studies of one source."""
        return [name for name, study in self.studies.items() if study.source == source]

    def job(self, rule: str, first: str, *others: str) -> Job:
        """The job of `rule` for the values of its wildcards; the first is a study or a run_id."""
        if hasattr(self, rule):
            job: Job = getattr(self, rule)(first, *others)
        elif first in self.runs:
            job = getattr(self.study_of(first), rule)(first)
        else:
            job = getattr(self.studies[first], rule)(*others)
        return job

    def trials(self, runs: Path) -> list[str]:
        """A line for each study: how many trials it has, and how many are new, without a fit below `runs`."""
        lines = []
        for name, study in self.studies.items():
            new = sum(not (runs / key / FIT).is_file() for key in study.runs)
            count = len(study.runs)
            lines.append(f"{name}: {count} trial{'s' * (count != 1)}, {new or 'none'} of them new")
        return lines

    @cached_property
    def trial_batches(self) -> dict[str, dict[str, list[str]]]:
        """The run_ids of each batch of each study; none of a study whose trials have a job each."""
        batches = self.settings.batches
        per_job = dict.fromkeys(self.studies, batches.trials_per_job)
        per_job |= dict.fromkeys(self.of_source("samples"), batches.maps_per_job)
        return {
            name: batches_of_runs(list(study.runs), per_job[name]) for name, study in self.studies.items()
        }

    def batch_of_trials(self, study: str, batch: str) -> Job:
        """The trials of one batch: of each its training and its score, and the files that they read."""
        of = self.studies[study]
        return {
            "trials": {
                key: {
                    "train": of.train(key),
                    "trains_on": of.trains_on(key),
                    "score": of.score(key),
                    "scored_on": of.scored_on(key),
                }
                for key in self.trial_batches[study][batch]
            }
        }

    def read_by_trials(self, study: str, batch: str) -> list[str]:
        """The files below the results that the trials of one batch read."""
        of, keys = self.studies[study], self.trial_batches[study][batch]
        return [file for key in keys for file in (*of.trains_on(key), *of.scored_on(key))]

    def shards(self, study: str, data: str, batch: str) -> Job:
        """The shards of one batch, by their files."""
        of = self.studies[study]
        assert not isinstance(of, FilesPlan | ModesPlan)  # which have one shard, and none
        return {
            "shards": {
                of.shard_file(data, number): of.simulate(data, number)
                for number in shards_of_batch(batch, of.shards(data))
            }
        }

    def waits_for(self, files: Iterable[str]) -> list[str]:
        """What a job waits for that reads `files`, below the results: they, or what their batches leave."""
        return list(dict.fromkeys(map(self._left_by_its_batch, files)))

    def _left_by_its_batch(self, file: str) -> str:
        if file.startswith("runs/"):
            return self._trials_left.get(file.split("/")[1], file)
        if shard := re.fullmatch(r"datasets/(.+)/(.+)/shard-(\d+)\.parquet", file):
            study, data, number = shard.groups()
            if isinstance(self.studies[study], FilesPlan):
                return file  # the rule `ingest` makes it
            total, per_job = self.studies[study].shards(data), self.settings.batches.shards_per_job
            batch = batch_of_shard(int(number), total, per_job)
            return f"datasets/{study}/{data}/shards-{batch}.json" if batch else file
        return file

    @cached_property
    def _trials_left(self) -> dict[str, str]:
        """What the batch of a run leaves, by its run_id."""
        return {
            key: f"batches/{study}/trials-{batch}.json"
            for study, batches in self.trial_batches.items()
            for batch, keys in batches.items()
            for key in keys
        }

    def store(self) -> Job:
        """The tracking store."""
        return {"uri": self.settings.tracking.uri, "studies": list(self.settings.studies)}

    def figures(self, study: str) -> list[str]:
        """The figures of one study."""
        return [name for name, figure in FIGURES.items() if self.studies[study].shows(figure)]

    def tables(self, study: str) -> list[str]:
        """The tables of one study."""
        return [name for name, table in TABLES.items() if self.studies[study].shows(table)]

    def made_together(self, study: str, products: Mapping[str, Product]) -> dict[str, list[str]]:
        """The figures or tables of one study that one job makes, by the rule whose files they show.

        To start Python takes longer than to draw a figure. What the structure or the aircraft is enough for
        goes by the name `design`.
        """
        together: dict[str, list[str]] = {}
        for name, product in products.items():
            if self.studies[study].shows(product):
                together.setdefault(self._shown_by(study, product), []).append(name)
        return together

    def shown(self, study: str, products: Mapping[str, Product], names: Iterable[str]) -> list[str]:
        """The files below the results that these figures or tables of one study read."""
        return list(dict.fromkeys(file for name in names for file in self.read_by(study, products[name])))

    def _shown_by(self, study: str, product: Product) -> str:
        files = self.read_by(study, product)
        if not files:
            return "design"
        if files[-1].startswith("runs/"):
            return "runs"
        names = {Path(file).stem for file in files}
        return next(rule for rule, made in self.studies[study].evaluation.items() if names <= set(made))

    def draw(self, study: str, shown: str) -> Job:
        """The figures of one study that show what the rule `shown` has made."""
        return {name: self._reads(study, FIGURES[name]) for name in self.made_together(study, FIGURES)[shown]}

    def tabulate(self, study: str, shown: str) -> Job:
        """The tables of one study that show what the rule `shown` has made."""
        return {name: self._reads(study, TABLES[name]) for name in self.made_together(study, TABLES)[shown]}

    def read_by(self, study: str, product: Product) -> list[str]:
        """The files below the results that a figure or table of one study reads."""
        return [file for read in product.reads for file in self.files(study, read)]

    def files(self, study: str, read: str) -> list[str]:
        """The files below the results that hold what a product of flexsurr.report `read`s."""
        if read in ("structure", "sweeps", "selection") or read in OF_AIRCRAFT:
            return []
        if read == "relatives":
            return [file for name in self._relatives(study) for file in self.files(name, "metrics")]
        if read in OF_RUNS:
            return [f"runs/{key}/{OF_RUNS[read]}" for key in self.studies[study].runs]
        names = [name for made in self.studies[study].evaluation.values() for name in made]
        found = [f"evaluation/{study}/{name}.parquet" for name in names if fnmatch(name, read)]
        if not found:
            raise ValueError(f"no rule makes {read}")
        return found

    def _relatives(self, study: str) -> list[str]:
        """The studies of the same structure, itself included."""
        plans = {name: plan for name, plan in self.studies.items() if isinstance(plan, TrajectoryPlan)}
        structure = plans[study].resolved.structure
        return [name for name, plan in plans.items() if plan.resolved.structure == structure]

    def _reads(self, study: str, product: Product) -> Job:
        reads = {read: self.files(study, read) for read in product.reads}
        return {"reads": reads, **self.studies[study].values_for(product)}
