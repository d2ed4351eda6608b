"""Choose the networks that the airliner flies with, and tabulate them beside the baselines."""

import json
from pathlib import Path
from typing import Any

import pandas as pd

from flexsurr.cli.command import Job, command
from flexsurr.cli.frames import read_frame, write_frame
from flexsurr.storage import StorageError, write_json
from flexsurr.training.tracking import end_sweep, read_store


def main(job: Job, runs: Path, store: Path, output: Path, table: Path) -> None:
    """Write {label: metrics of the best run that finished} to `output` and their accuracies to `table`.

    Best is the least validation nmse. Raises StorageError where no network has finished.
    """
    metrics = {
        key: json.loads((runs / key / "metrics.json").read_text(encoding="utf-8")) for key in job["runs"]
    }
    best: dict[str, dict[str, Any]] = {}
    for figures in metrics.values():
        if figures["status"] != "finished" or figures["validation_nmse"] is None:
            continue
        known = best.get(figures["label"])
        if known is None or figures["validation_nmse"] < known["validation_nmse"]:
            best[figures["label"]] = figures
    if "network" not in best:
        raise StorageError(f"{runs}: no network of the airliner has finished; see their metrics.json")
    frames = [read_frame(runs / chosen["run_id"] / "accuracy.parquet") for chosen in best.values()]
    write_frame(table, pd.concat(frames, ignore_index=True))
    write_json(output, best)
    end_sweep(read_store(store), job["study"], metrics)


if __name__ == "__main__":
    command(
        main,
        {
            "runs": "the folder of all runs",
            "store": "the address of the store",
            "output": "the selection",
            "table": "output, train_nmse, validation_nmse, validation_r2, model",
        },
    )
