"""A batch of trials: each is trained and scored once, and again only for what has changed."""

from pathlib import Path

import pytest

from flexsurr.cli.batch import TRAINED, make_all, trials_of
from flexsurr.storage import StorageError, read_json


class Batch:
    """Two trials whose training and score write down that they were done."""

    def __init__(self, results: Path) -> None:
        self.results = results
        self.done: list[str] = []
        self.refused: set[str] = set()
        self.job = {"trials": {key: self.trial(key) for key in ("a", "b")}}
        (results / "data").mkdir()
        (results / "data/manifest.json").write_text("{}")

    @staticmethod
    def trial(key: str) -> dict:
        return {
            "train": {"run_id": key, "epochs": 3},
            "trains_on": ["data/manifest.json"],
            "score": {"run_id": key, "long_responses": 2},
            "scored_on": ["data/manifest.json"],
        }

    def train(self, job: dict, data: list[Path], store: Path, folder: Path) -> None:
        self.done.append(f"train {job['run_id']}")
        if job["run_id"] in self.refused:
            raise ArithmeticError("it leaves the finite numbers")
        folder.mkdir(parents=True, exist_ok=True)
        for name in TRAINED:
            (folder / name).write_text(str(job))

    def score(self, job: dict, fit: Path, weights: Path, best: Path, data: list[Path], output: Path) -> None:
        self.done.append(f"score {job['run_id']}")
        assert all(file.is_file() for file in (fit, weights, best, *data))
        output.write_text(str(job))

    def make(self) -> list[str]:
        """What is done when the batch is started."""
        self.done.clear()
        items = trials_of(self.job, self.results, self.results / "store.json", self.train, self.score)
        make_all(items, self.results, self.results / "batches/made.json", (ArithmeticError,))
        return list(self.done)


@pytest.fixture
def code(monkeypatch) -> dict[str, str]:
    """The digest of each command's code, by the name of its function; those not in here are the name."""
    digests: dict[str, str] = {}
    monkeypatch.setattr("flexsurr.cli.batch.code_digest", lambda part: digests.get(part.split(":")[1], part))
    return digests


@pytest.fixture
def batch(tmp_path: Path, code) -> Batch:
    return Batch(tmp_path)


def test_each_trial_is_trained_and_scored_once(batch):
    assert batch.make() == ["train a", "score a", "train b", "score b"]
    assert batch.make() == []
    made = read_json(batch.results / "batches/made.json")["made"]
    assert all((batch.results / file).is_file() for file in made)
    assert {"runs/a/weights.npz", "runs/b/metrics.json"} <= set(made)


def test_what_is_scored_otherwise_is_not_trained_again(batch):
    batch.make()
    batch.job["trials"]["a"]["score"]["long_responses"] = 5
    assert batch.make() == ["score a"]


def test_what_is_trained_otherwise_is_scored_again(batch):
    batch.make()
    batch.job["trials"]["b"]["train"]["epochs"] = 4
    assert batch.make() == ["train b", "score b"]


def test_other_data_make_all_of_it_again(batch):
    batch.make()
    (batch.results / "data/manifest.json").write_text('{"shards": 2}')
    assert batch.make() == ["train a", "score a", "train b", "score b"]


def test_other_code_makes_again_what_it_makes(batch, code):
    batch.make()
    code["score"] = "edited"
    assert batch.make() == ["score a", "score b"]
    code["train"] = "edited"
    assert batch.make() == ["train a", "train b"]


def test_a_file_that_is_gone_is_made_again(batch):
    batch.make()
    (batch.results / "runs/a/metrics.json").unlink()
    assert batch.make() == ["score a"]


def test_a_trial_that_is_refused_leaves_the_others_and_ends_the_batch(batch):
    batch.refused.add("a")
    with pytest.raises(StorageError, match="a: it leaves the finite numbers"):
        batch.make()
    assert batch.done == ["train a", "train b", "score b"]
    assert not (batch.results / "batches/made.json").exists()
    batch.refused.clear()
    assert batch.make() == ["train a", "score a"]
