"""Train and score many surrogates of maps, one after another: those of a batch that are not there."""

from pathlib import Path

from flexsurr.cli.batch import make_all, trials_of
from flexsurr.cli.command import Job, command
from flexsurr.cli.score_map import main as score
from flexsurr.cli.train_map import main as train


def main(job: Job, results: Path, store: Path, output: Path) -> None:
    """Make the runs of the job below `results`, and write their names to `output`."""

    def make(trial: Job, folder: Path, trains_on: list[Path], scored_on: list[Path]) -> None:
        train(trial["train"], sorted({file.parent for file in trains_on}), store, folder)
        fit, weights, best = (folder / name for name in ("fit.json", "weights.npz", "best.npz"))
        score(trial["score"], fit, weights, best, scored_on, folder / "metrics.json")

    make_all(trials_of(job, results, make), "map_trials", results, output)


if __name__ == "__main__":
    command(
        main,
        {"results": "the folder of results", "store": "the address of the store", "output": "what is made"},
    )
