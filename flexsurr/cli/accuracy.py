"""What the selected maps err by, output by output, and where the network's errors lie."""

from pathlib import Path

import pandas as pd

from flexsurr.aerodynamics.features import COEFFICIENTS, FEATURES
from flexsurr.cli.command import Job, command
from flexsurr.cli.frames import write_frame
from flexsurr.evaluation.columns import ACCURACY_COLUMNS
from flexsurr.storage import read_all_samples, read_json
from flexsurr.surrogates import load_map
from flexsurr.training.map_data import accuracy as accuracy_of
from flexsurr.training.map_data import held_out_errors, map_data


def main(job: Job, selection: Path, runs: Path, datasets: Path, accuracy: Path, errors: Path) -> None:
    """Write the accuracy of each selected map, and the errors of the network on its held-out samples.

    Where no map, or no network, has finished there are columns alone.
    """
    tables = []
    found = pd.DataFrame(columns=[*FEATURES, *(f"error_{name}" for name in COEFFICIENTS)], dtype=float)
    for label, chosen in read_json(selection).items():
        name = chosen["variant"]
        read = job["samples"][name]
        shards = [datasets / name / f"shard-{number:04d}.parquet" for number in range(job["shards"])]
        samples = read_all_samples(shards, read["configuration"], read["samples"])
        data = map_data(samples, read["held_out"], read["seed"])
        predicted = load_map(runs / chosen["run_id"] / "weights.npz")(data.u)
        tables.append(accuracy_of(data, predicted, label))
        if label == "network":
            found = held_out_errors(data, predicted)
    write_frame(errors, found)
    none = pd.DataFrame(columns=ACCURACY_COLUMNS)
    write_frame(accuracy, pd.concat(tables, ignore_index=True) if tables else none)


if __name__ == "__main__":
    command(
        main,
        {
            "selection": "the selected maps",
            "runs": "the folder of all runs",
            "datasets": "the folder of all samples of the study",
            "accuracy": "one row an output and map",
            "errors": "one row a held-out sample",
        },
    )
