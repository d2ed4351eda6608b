"""Judge every run of a study by long responses that no training has seen."""

import json
import logging
from collections.abc import Mapping
from pathlib import Path
from typing import Any, get_args

from flexsurr.beam import EquilibriumNotFound, ModalBasis, reduce
from flexsurr.cli.command import Job, command
from flexsurr.config.part import part_of
from flexsurr.config.structure import Structure
from flexsurr.config.study import Study, Variant
from flexsurr.evaluation.cases import Reference
from flexsurr.evaluation.held_out import held_out_errors
from flexsurr.evaluation.selection import long_response_errors, long_responses
from flexsurr.storage import read_manifest, write_json
from flexsurr.surrogates import load
from flexsurr.training import Dataset, load_dataset

log = logging.getLogger(__name__)


def main(job: Job, runs: Path, manifests: list[Path]) -> None:
    """Write metrics.json of each of the job's runs, found below `runs`.

    `manifests` holds one dataset for each variant, on whose held-out trajectories all fields are judged.
    """
    datasets = {read_manifest(path).variant: load_dataset(path) for path in manifests}
    study = part_of(Study, job["part"])
    basis = reduce(Structure.model_validate(job["structure"]), study.reduction)
    # the same for every run of a variant
    variants = [variant for variant in get_args(Variant) if variant in datasets]
    references = {variant: long_responses(study, basis, variant) for variant in variants}
    for key in job["runs"]:
        metrics = _judge(study, basis, datasets, references, runs / key)
        write_json(runs / key / "metrics.json", metrics)
        log.info(
            "%s: %s, validation nmse %s, long responses %s %%",
            key,
            metrics["status"],
            metrics["validation_nmse"],
            metrics.get("long_response_error_percent_worst"),
        )


def _judge(
    study: Study,
    basis: ModalBasis,
    datasets: Mapping[str, Dataset],
    references: Mapping[str, list[Reference]],
    folder: Path,
) -> dict[str, Any]:
    """What training says of the run and, unless it failed, what its field and its long responses say."""
    fit: dict[str, Any] = json.loads((folder / "fit.json").read_text(encoding="utf-8"))
    fit["normalisation"] = study.reduction.normalisation
    if fit["status"] != "finished":
        return fit
    surrogate = load(folder / "weights.npz")
    variant = fit["variant"]
    held_out = held_out_errors(surrogate, datasets[variant])
    return fit | held_out | long_response_errors(study, basis, variant, surrogate, references[variant])


if __name__ == "__main__":
    command(
        main,
        {"runs": "the folder of all runs", "manifests": "one dataset of each variant …"},
        expected=(EquilibriumNotFound, ArithmeticError),
    )
