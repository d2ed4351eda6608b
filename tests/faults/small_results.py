"""Results of two trainings made by the commands themselves."""

import json
from dataclasses import dataclass
from pathlib import Path

from flexsurr.cli import datasets, evaluation, report, scoring, selection, training, trajectories
from flexsurr.config.settings import load
from flexsurr.storage.frames import read_frame
from flexsurr.workflow.job_files import write_job
from flexsurr.workflow.plan import Plan

REPOSITORY = Path(__file__).resolve().parents[2]
PLAN = Plan(load(REPOSITORY, ["config/config.yaml", "config/presets/quick.yaml"]))
STUDY, VARIANT = "cantilever", "hamiltonian"
RUNS = [key for key in PLAN.studies[STUDY].runs if PLAN.runs[key].variant == VARIANT]
RUN, OTHER = (next(key for key in RUNS if key.startswith(kind)) for kind in ("polynomial", "hnn"))


MEASURED = ("wall_s", "processor_s")
"""What differs from one run to the next."""


def content(path: Path) -> object:
    """What a file says, but for times: each byte, of JSON each value, of a history each row."""
    if path.suffix == ".json":
        return json.loads(path.read_text(), object_hook=_untimed)
    if path.name == "history.parquet":
        return read_frame(path).drop(columns=list(MEASURED), errors="ignore").to_dict()
    return path.read_bytes()


def _untimed(values: dict) -> dict:
    return {key: value for key, value in values.items() if key not in MEASURED}


@dataclass(frozen=True)
class Results:
    """A folder of results and the commands that read them."""

    root: Path

    @property
    def dataset(self) -> Path:
        return self.root / "datasets" / STUDY / VARIANT

    @property
    def run(self) -> Path:
        return self.root / "runs" / RUN

    def job(self, name: str, *keys: str) -> dict:
        job = PLAN.job(name, *keys)
        write_job(self.root / "jobs", name, job)
        return job

    def simulate(self, shard: int, path: Path | None = None) -> None:
        path = path or self.dataset / f"shard-{shard:04d}.parquet"
        trajectories.simulate(self.job("simulate", STUDY, VARIANT, shard), path)

    def manifest(self, path: Path | None = None) -> None:
        job = self.job("manifest", STUDY, VARIANT)
        datasets.manifest(job, self.dataset, path or self.dataset / "manifest.json")

    def train(self, key: str = RUN) -> None:
        store = self.root / "mlflow/store.json"  # there is none: the page is tested elsewhere
        training.train(self.job("train", key), [self.dataset], store, self.root / "runs" / key)

    def score(self, key: str = RUN) -> None:
        run = self.root / "runs" / key
        files = [run / "fit.json", run / "weights.npz", run / "best.npz"]
        scoring.score(self.job("score", key), *files, [self.dataset / "manifest.json"], run / "metrics.json")

    def select(self) -> None:
        job = {"study": STUDY, "sweeps": {"default": [RUN, OTHER]}, "selection": {}}
        output = self.root / "selected" / f"{STUDY}.json"
        selection.select(job, self.root / "runs", output)

    def statics(self) -> None:
        folder = self.root / "evaluation" / STUDY
        files = (folder / f"{name}.parquet" for name in ("statics", "frequencies", "shapes"))
        evaluation.statics(self.job("statics", STUDY), *files)

    def tabulate(self, table: str) -> None:
        caption = REPOSITORY / "workflow/report" / f"{table}.rst"
        job = {table: self.job("tabulate", STUDY, "statics")[table]}
        report.tabulate(job, self.root, [caption], self.root / "tables" / STUDY)
