"""Judge every run of a study by long responses that no training has seen."""

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

log = logging.getLogger(__name__)


def main(job: Job, runs: Path) -> None:
    """Write metrics.json of each of the job's runs, found below `runs`."""
    study = part_of(Study, job["part"])
    basis = reduce(Structure.model_validate(job["structure"]), study.reduction)
    for key in job["runs"]:
        metrics = _judge(study, basis, runs / key)
        write_json(runs / key / "metrics.json", metrics)
        log.info(
            "%s: %s, validation nmse %s, long responses %s %%",
            key,
            metrics["status"],
            metrics["validation_nmse"],
            metrics.get("long_response_error_percent_worst"),
        )


def _judge(study: Study, basis: ModalBasis, folder: Path) -> dict[str, Any]:
    """What training says of the run and, unless it failed, what its long responses say."""
    fit: dict[str, Any] = json.loads((folder / "fit.json").read_text(encoding="utf-8"))
    if fit["status"] != "finished":
        return fit
    return fit | long_response_errors(study, basis, fit["variant"], load(folder / "weights.npz"))


if __name__ == "__main__":
    command(
        main,
        {"runs": "the folder of all runs"},
        expected=(EquilibriumNotFound, ArithmeticError),
    )
