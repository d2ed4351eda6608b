"""Judge every run of a study by long responses, and choose the surrogates that are evaluated."""

import json
import logging
from pathlib import Path
from typing import Any

from flexsurr.beam import EquilibriumNotFound, ModalBasis, reduce
from flexsurr.cli.command import Job, command
from flexsurr.config.part import part_of
from flexsurr.config.structure import Structure
from flexsurr.config.study import Study
from flexsurr.evaluation import long_response_errors
from flexsurr.storage import write_json
from flexsurr.surrogates import load
from flexsurr.training import select
from flexsurr.training.tracking import end_sweep, read_store

log = logging.getLogger(__name__)

DEFAULT_SWEEP = "default"


def main(job: Job, runs: Path, store: Path, output: Path) -> None:
    """Write metrics.json of each run below `runs`, the selection to `output`, and end the sweep.

    The best surrogate of the sweep `default` goes by the name of its architecture (`hnn`), that of
    another sweep has the sweep's name added (`hnn_paper`).
    """
    study = part_of(Study, job["part"])
    basis = reduce(Structure.model_validate(job["structure"]), study.reduction)
    keys = dict.fromkeys(
        key for variants in job["sweeps"].values() for keys in variants.values() for key in keys
    )
    metrics = {key: _judge(study, basis, runs / key) for key in keys}
    selection: dict[str, dict[str, Any]] = {}
    for sweep, variants in job["sweeps"].items():
        for variant, chosen in select([metrics[key] for keys in variants.values() for key in keys]).items():
            for name, entry in chosen.items():
                known_as = name if sweep == DEFAULT_SWEEP else f"{name}_{sweep}"
                selection.setdefault(variant, {})[known_as] = entry
    write_json(output, selection)
    end_sweep(read_store(store), job["study"], metrics)


def _judge(study: Study, basis: ModalBasis, folder: Path) -> dict[str, Any]:
    metrics: dict[str, Any] = json.loads((folder / "fit.json").read_text(encoding="utf-8"))
    if metrics["status"] == "finished":
        surrogate = load(folder / "weights.npz")
        metrics |= long_response_errors(study, basis, metrics["variant"], surrogate)
    write_json(folder / "metrics.json", metrics)
    log.info(
        "%s: %s, validation nmse %s, long responses %s %%",
        metrics["run_id"],
        metrics["status"],
        metrics["validation_nmse"],
        metrics.get("long_response_error_percent_worst"),
    )
    return metrics


if __name__ == "__main__":
    command(
        main,
        {"runs": "the folder of all runs", "store": "the address of the store", "output": "the selection"},
        expected=(EquilibriumNotFound, ArithmeticError),
    )
