"""Score one run: its field on held-out samples, and long responses that no training has seen."""

import json
import logging
from pathlib import Path
from typing import Any

from flexsurr.beam import EquilibriumNotFound, reduce
from flexsurr.cli.command import Job, command
from flexsurr.config.part import part_of
from flexsurr.config.structure import Structure
from flexsurr.config.study import Study
from flexsurr.evaluation.held_out import held_out_errors
from flexsurr.evaluation.selection import long_response_errors, long_responses
from flexsurr.storage import write_json
from flexsurr.surrogates import load
from flexsurr.training import load_dataset

log = logging.getLogger(__name__)


def main(job: Job, fit: Path, weights: Path, best: Path, manifest: Path, output: Path) -> None:
    """Write the run's metrics: what training says of it and, unless that failed, its scores.

    `manifest` is that of the dataset on whose held-out samples every surrogate of the variant is scored.
    Where the run keeps its last weights, those that validated best are scored too, as `best_…`.
    """
    study, variant = part_of(Study, job["part"]), job["variant"]
    metrics: dict[str, Any] = json.loads(fit.read_text(encoding="utf-8"))
    structure = Structure.model_validate(job["structure"])
    metrics |= {"structure": structure.name, "normalisation": study.reduction.normalisation}
    if metrics["status"] == "finished":
        basis = reduce(structure, study.reduction)
        surrogate = load(weights)
        metrics |= held_out_errors(surrogate, load_dataset(manifest))
        references = long_responses(study, basis, variant)
        metrics |= long_response_errors(study, basis, variant, surrogate, references)
        if metrics["keep"] == "last":
            others = long_response_errors(study, basis, variant, load(best), references)
            metrics |= {f"best_{name}": value for name, value in others.items()}
    write_json(output, metrics)
    log.info(
        "%s, validation nmse %s, long responses %s %%",
        metrics["status"],
        metrics["validation_nmse"],
        metrics.get("long_response_error_percent_worst"),
    )


if __name__ == "__main__":
    command(
        main,
        {
            "fit": "what training says of the run",
            "weights": "the surrogate that it keeps",
            "best": "the one that validated best",
            "manifest": "the dataset to score it on",
            "output": "its metrics",
        },
        expected=(EquilibriumNotFound, ArithmeticError),
    )
