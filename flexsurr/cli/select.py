"""Choose the surrogates of a study that are evaluated."""

import logging
from pathlib import Path
from typing import Any

from flexsurr.cli.command import Job, command
from flexsurr.cli.runs import read_run
from flexsurr.storage import write_json
from flexsurr.training import select
from flexsurr.training.selection import select_maps

log = logging.getLogger(__name__)

DEFAULT_SWEEP = "default"

SAYS_WHY = "table sweeps.csv says why"


def main(job: Job, runs: Path, output: Path) -> None:
    """Write the selection from the metrics of the runs below `runs` to `output`.

    The best surrogate of the sweep `default` goes by the name of its architecture (`hnn`), that of
    another sweep has the sweep's name added (`hnn_paper`). Of a study of maps there is the best for each of
    the trials' labels.
    """
    selection: dict[str, dict[str, Any]] = {}
    for sweep, keys in job["sweeps"].items():
        records = [read_run(runs / key / "metrics.json") for key in keys]
        if job.get("maps"):
            best = select_maps(records)
            selection |= {name if sweep == DEFAULT_SWEEP else f"{name}_{sweep}": best[name] for name in best}
            continue
        for variant, chosen in select(records).items():
            for name, entry in chosen.items():
                known_as = name if sweep == DEFAULT_SWEEP else f"{name}_{sweep}"
                selection.setdefault(variant, {})[known_as] = entry
    if job.get("maps") and selection and "network" not in selection:
        log.warning("no network of %s has finished; its %s", job["study"], SAYS_WHY)
    if not selection:
        log.warning("no trial of %s has finished; its %s", job["study"], SAYS_WHY)
    write_json(output, selection)


if __name__ == "__main__":
    command(main, {"runs": "the folder of all runs", "output": "the selection"})
