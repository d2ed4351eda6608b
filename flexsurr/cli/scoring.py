"""Scores of runs."""

import json
import logging
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

from flexsurr.beam import EquilibriumNotFound, reduce
from flexsurr.cli.command import Job, for_rules
from flexsurr.cli.runs import read_run
from flexsurr.config.files import FilesStudy
from flexsurr.config.schema import part_of
from flexsurr.config.structure import Structure
from flexsurr.config.study import Study
from flexsurr.evaluation.operations import counted_outputs
from flexsurr.evaluation.rollouts import HeldOutTrajectories, rollout_errors
from flexsurr.evaluation.scores import (
    held_out_errors,
    long_response_errors,
    long_responses,
    reference_operations,
)
from flexsurr.storage import read_manifest, write_json
from flexsurr.surrogates import load, load_map
from flexsurr.training import load_dataset

log = logging.getLogger(__name__)

Errors = Callable[[Any], dict[str, Any]]
"""The errors of a surrogate's long responses, by their names in its metrics."""


@for_rules(
    EquilibriumNotFound,
    ArithmeticError,
    fit="what training says of the run",
    weights="the surrogate that it keeps",
    best="the one that validated best",
    manifest="the dataset to score it on, where there is one",
    output="its metrics",
)
def score(job: Job, fit: Path, weights: Path, best: Path, manifest: list[Path], output: Path) -> None:
    """Score one run: its field on held-out samples, and long responses that no training has seen.

    `output` gets the run's metrics: what training says of it and, unless that failed, its scores. `manifest`
    is that of the dataset on whose held-out samples every surrogate of the variant is scored; a study without
    datasets has none. Where the run keeps its last weights, those that validated best
    are scored too, as `best_…`.
    """
    metrics = read_run(fit) | _setting(job)
    if metrics["status"] == "finished":
        surrogate = load(weights)
        errors = _beside_reference(job) if "structure" in job else _beside_recordings(job, manifest[0])
        for dataset in manifest:
            metrics |= held_out_errors(surrogate, load_dataset(dataset))
        metrics |= errors(surrogate)
        if metrics["keep"] == "last":
            metrics |= {f"best_{name}": value for name, value in errors(load(best)).items()}
    write_json(output, metrics)
    log.info(
        "%s, validation nmse %s, long responses %s %%",
        metrics["status"],
        metrics["validation_nmse"],
        metrics.get("long_response_error_percent_worst"),
    )


def _setting(job: Job) -> dict[str, Any]:
    """What metrics say of the structure, if the study has one."""
    if "structure" not in job:
        return {"structure": None, "normalisation": None}
    normalisation = part_of(Study, job["part"]).reduction.normalisation
    return {"structure": job["structure"]["name"], "normalisation": normalisation}


def _beside_reference(job: Job) -> Errors:
    """Errors of long responses, from the reference model's."""
    return _beside_reference_of(json.dumps(job, sort_keys=True))


@cache
def _beside_reference_of(values: str) -> Errors:
    """The same of a job as JSON: the trials of a batch have the same references."""
    job = json.loads(values)
    study, variant = part_of(Study, job["part"]), job["variant"]
    basis = reduce(Structure.model_validate(job["structure"]), study.reduction)
    references = long_responses(study, basis, variant)
    costs = reference_operations(basis, variant)
    return lambda surrogate: costs | long_response_errors(study, basis, variant, surrogate, references)


def _beside_recordings(job: Job, manifest: Path) -> Errors:
    """Errors of rollouts, from held-out trajectories of the user's files."""
    settings = part_of(FilesStudy, job["part"]).rollouts
    held_out = HeldOutTrajectories.of(read_manifest(manifest), settings.trajectories)
    return lambda surrogate: rollout_errors(surrogate, held_out, settings.integrator)


@for_rules(
    fit="what training says of the run",
    weights="the surrogate that it keeps",
    best="the one that validated best",
    manifest="none",
    output="its metrics",
)
def score_map(job: Job, fit: Path, weights: Path, best: Path, manifest: list[Path], output: Path) -> None:
    """Score one run of a map: by its errors on held-out samples, which training has written, and its cost.

    There is no `manifest` of a map.
    """
    metrics = read_run(fit)
    if metrics["status"] == "finished":
        learned = load_map(weights)
        metrics["operations"] = counted_outputs(learned.compiled(), learned.inputs.origin)[1]
    write_json(output, metrics)
