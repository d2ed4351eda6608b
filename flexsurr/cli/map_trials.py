"""Train and score many surrogates of maps, one after another: those of a batch that are not there."""

from pathlib import Path

from flexsurr.cli.batch import JUDGED, make_all, trials_of
from flexsurr.cli.command import Job, command
from flexsurr.cli.score_map import main as score
from flexsurr.cli.train_map import main as train


def main(job: Job, results: Path, store: Path, output: Path) -> None:
    """Make the runs of the job below `results`, and write what is made to `output`."""

    def trained(trial: Job, trains_on: list[Path], folder: Path) -> None:
        train(trial, sorted({file.parent for file in trains_on}), store, folder)

    def scored(trial: Job, folder: Path, scored_on: list[Path]) -> None:
        fit, weights, best = (folder / name for name in JUDGED)
        score(trial, fit, weights, best, scored_on, folder / "metrics.json")

    make_all(trials_of(job, results, trained, scored, ("train_map", "score_map")), results, output)


if __name__ == "__main__":
    command(
        main,
        {"results": "the folder of results", "store": "the address of the store", "output": "what is made"},
    )
