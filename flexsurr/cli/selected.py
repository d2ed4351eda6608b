"""The surrogates of a selection."""

from pathlib import Path
from typing import Any

from flexsurr.cli.runs import read_selection
from flexsurr.surrogates import load
from flexsurr.training.selection import ERROR


def selected_surrogates(selection: Path, variant: str, runs: Path) -> dict[str, Any]:
    """The surrogates selected for `variant`, by the names under which tables show them."""
    chosen = selected_runs(selection, variant)
    return {name: load(runs / entry["run_id"] / "weights.npz") for name, entry in chosen.items()}


def most_accurate(selection: Path, variant: str) -> str | None:
    """The name of the surrogate of `variant` whose long responses err least; None if none was selected."""
    chosen = selected_runs(selection, variant)
    return min(chosen, key=lambda name: chosen[name][ERROR], default=None)


def selected_runs(selection: Path, variant: str) -> dict[str, dict[str, Any]]:
    """The metrics of the run of each name; the Pareto sets, which are lists, are left out."""
    entries = read_selection(selection).get(variant, {})
    return {name: entry for name, entry in entries.items() if isinstance(entry, dict)}
