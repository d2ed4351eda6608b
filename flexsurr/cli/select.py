"""Choose the surrogates of a study that are evaluated, and end its sweeps."""

import json
from pathlib import Path
from typing import Any

from flexsurr.cli.command import Job, command
from flexsurr.storage import write_json
from flexsurr.training import select
from flexsurr.training.tracking import end_sweep, read_store

DEFAULT_SWEEP = "default"


def main(job: Job, runs: Path, store: Path, output: Path) -> None:
    """Write the selection from the metrics of the runs below `runs` to `output`, and end the sweeps.

    The best surrogate of the sweep `default` goes by the name of its architecture (`hnn`), that of
    another sweep has the sweep's name added (`hnn_paper`).
    """
    selection: dict[str, dict[str, Any]] = {}
    metrics: dict[str, dict[str, Any]] = {}
    for sweep, keys in job["sweeps"].items():
        for key in keys:
            metrics[key] = json.loads((runs / key / "metrics.json").read_text(encoding="utf-8"))
        for variant, chosen in select([metrics[key] for key in keys]).items():
            for name, entry in chosen.items():
                known_as = name if sweep == DEFAULT_SWEEP else f"{name}_{sweep}"
                selection.setdefault(variant, {})[known_as] = entry
    write_json(output, selection)
    end_sweep(read_store(store), job["study"], metrics)


if __name__ == "__main__":
    command(
        main,
        {"runs": "the folder of all runs", "store": "the address of the store", "output": "the selection"},
    )
