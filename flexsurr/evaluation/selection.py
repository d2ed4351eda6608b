"""Which of a sweep's surrogates to show: by the error of a long response and by cost, not by the loss."""

import math
from collections.abc import Callable, Iterable, Mapping
from typing import Any

Record = Mapping[str, Any]
ERROR = "long_response_error_percent_worst"
NMSE = "validation_nmse"
"""By which maps are chosen, for they have no response."""
COST = "operations"


def select(
    records: Iterable[Record], error_at_most_percent: float | None = None
) -> dict[str, dict[str, Any]]:
    """Per variant: under each architecture the chosen run, under "pareto" those that none beats in both.

    Chosen is as `choose` has it. Beaten means: another right-hand side takes no more operations and has no
    larger worst error of a long response, and is better in one. Runs that failed, or whose response diverged,
    are left out. The Pareto set runs from the cheapest to the most accurate.
    """
    selection: dict[str, dict[str, Any]] = {}
    runs: dict[tuple[str, str], dict[str, Record]] = {}
    for record in sorted(filter(_usable, records), key=_by(ERROR, COST)):
        pareto = selection.setdefault(record["variant"], {"pareto": []})["pareto"]
        runs.setdefault((record["variant"], record["architecture"]), {})[record["run_id"]] = record
        # from the most accurate on: a run belongs to the set if it is cheaper than all before it
        if all(_cost(record) < _cost(better) for better in pareto):
            pareto.insert(0, dict(record))
    for (variant, architecture), of_one in runs.items():
        selection[variant][architecture] = dict(of_one[choose(of_one, error_at_most_percent)])
    return selection


def choose(records: Mapping[str, Record], at_most: float | None = None, error: str = ERROR) -> str:
    """The name in `records` of the run, of those that err by so little, which takes the fewest operations.

    The most accurate of all where none does, or where there is no such limit. What is equal goes by the
    other, then by the run_id, so that the choice does not depend on the order.
    """
    most_accurate, cheapest = _by(error, COST), _by(COST, error)
    best, *others = sorted(records, key=lambda name: most_accurate(records[name]))
    enough = [name for name in (best, *others) if records[name][error] <= (at_most or 0.0)]
    return min(enough, key=lambda name: cheapest(records[name]), default=best)


def select_maps(records: Iterable[Record], nmse_at_most: float | None = None) -> dict[str, dict[str, Any]]:
    """Under each label the run of a map that `choose` has by the validation nmse, failed runs left out.

    Labels come in the order of `records`.
    """
    runs: dict[str, dict[str, Record]] = {}
    for record in records:
        if record["status"] == "finished" and record[NMSE] is not None:
            runs.setdefault(record["label"], {})[record["run_id"]] = record
    return {label: dict(of_one[choose(of_one, nmse_at_most, NMSE)]) for label, of_one in runs.items()}


def _usable(record: Record) -> bool:
    return record["status"] == "finished" and record.get(ERROR) is not None and not record.get("diverged")


def _cost(record: Record) -> float:
    """Operations; without end where the equations call Python, which costs more than any that do not."""
    return math.inf if record[COST] is None else float(record[COST])


def _by(*keys: str) -> Callable[[Record], tuple[float | str, ...]]:
    """What sorts runs by these keys, the least first, and what is equal in all by the run_id."""
    return lambda record: (*(_cost(record) if key == COST else record[key] for key in keys), record["run_id"])
