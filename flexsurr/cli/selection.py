"""The choice among runs."""

import logging
from pathlib import Path
from typing import Any

from flexsurr.cli.command import Job, for_rules
from flexsurr.cli.runs import read_run
from flexsurr.evaluation.selection import choose, select_maps
from flexsurr.evaluation.selection import select as select_fields
from flexsurr.storage import write_json

log = logging.getLogger(__name__)

DEFAULT_SWEEP = "default"

SAYS_WHY = "table sweeps.csv says why"


@for_rules(runs="the folder of all runs", output="the selection")
def select(job: Job, runs: Path, output: Path) -> None:
    """Select the surrogates of a study that are evaluated.

    It follows from the metrics of the runs below `runs`. The best surrogate of the sweep `default` goes by
    the name of its architecture (`hnn`), that of another sweep has the sweep's name added (`hnn_paper`).
    Under "chosen" stands the name of the one that the study's rule chooses among them all. Of a study of maps
    there is what the rule chooses for each of the trials' labels. Under "chosen_by" each entry has the rule.
    """
    chosen_by = {"chosen_by": job["selection"]}
    selection: dict[str, dict[str, Any]] = {}
    for sweep, keys in job["sweeps"].items():
        records = [read_run(runs / key / "metrics.json") for key in keys]
        if job.get("maps"):
            best = select_maps(records, **job["selection"])
            for name, entry in best.items():
                selection[name if sweep == DEFAULT_SWEEP else f"{name}_{sweep}"] = entry | chosen_by
            continue
        for variant, chosen in select_fields(records, **job["selection"]).items():
            for name, entry in chosen.items():
                known_as = name if sweep == DEFAULT_SWEEP else f"{name}_{sweep}"
                selection.setdefault(variant, {})[known_as] = entry if name == "pareto" else entry | chosen_by
    if not job.get("maps"):
        for chosen in selection.values():
            entries = {name: entry for name, entry in chosen.items() if isinstance(entry, dict)}
            chosen["chosen"] = choose(entries, job["selection"].get("error_at_most_percent"))
    if job.get("maps") and selection and "network" not in selection:
        log.warning("no network of %s has finished; its %s", job["study"], SAYS_WHY)
    if not selection:
        log.warning("no trial of %s has finished; its %s", job["study"], SAYS_WHY)
    write_json(output, selection)
