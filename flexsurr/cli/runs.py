"""What is written of runs (fit.json, metrics.json), and the runs that a study has selected."""

from pathlib import Path
from typing import Any

from flexsurr.evaluation.selection import ERROR
from flexsurr.storage import DamagedFile, read_json

OF_A_RUN = ("run_id", "study", "status")

SELECTED = {"selection": "the selected runs", "runs": "the folder of all runs"}
"""What commands are given that read the selected runs."""


def read_run(path: Path) -> dict[str, Any]:
    """What a file in a run's folder says of it; DamagedFile for a damaged one, or another run's."""
    content = read_json(path, OF_A_RUN)
    if content["run_id"] != path.parent.name:
        raise DamagedFile(f"{path}: another run's: that of {content['run_id']}")
    return content


def selected_runs(selection: Path, variant: str) -> dict[str, dict[str, Any]]:
    """The metrics of the run of each name, without the Pareto sets and the name that is chosen of all."""
    entries = _read_selection(selection).get(variant, {})
    return {name: entry for name, entry in entries.items() if isinstance(entry, dict)}


def selected_surrogates(selection: Path, variant: str, runs: Path) -> dict[str, Any]:
    """The surrogates selected for `variant`, by the names under which tables show them."""
    from flexsurr.surrogates import load  # here: tables read runs too, and need no kernels

    chosen = selected_runs(selection, variant)
    return {name: load(runs / entry["run_id"] / "weights.npz") for name, entry in chosen.items()}


def most_accurate(selection: Path, variant: str) -> str | None:
    """The name of the surrogate of `variant` whose long responses err least; None if none was selected."""
    chosen = selected_runs(selection, variant)
    return min(chosen, key=lambda name: chosen[name][ERROR], default=None)


def _read_selection(path: Path) -> dict[str, dict[str, Any]]:
    """Variant -> name -> what is written of the chosen run, and under "pareto" a list of such.

    Under "chosen" stands the name of the one that is chosen of all.

    DamagedFile for a damaged one, or that of another study.
    """
    content = read_json(path)
    for chosen in content.values():
        entries = (
            [each for each in chosen.values() if isinstance(each, dict)] if isinstance(chosen, dict) else []
        )
        if not entries or not all(entry.keys() >= set(OF_A_RUN) for entry in entries):
            raise DamagedFile(f"{path}: no choice among runs")
        if foreign := {entry["study"] for entry in entries} - {path.stem}:
            raise DamagedFile(f"{path}: another's: the choice among the runs of {', '.join(sorted(foreign))}")
    return content
