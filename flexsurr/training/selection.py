"""Which of a sweep's surrogates to show: by the error of a long response, not by the loss."""

from collections.abc import Iterable, Mapping
from typing import Any

Record = Mapping[str, Any]
ERROR = "long_response_error_percent_worst"
COST = "parameters"


def select(records: Iterable[Record]) -> dict[str, dict[str, Any]]:
    """Per variant: under each architecture its best run, under "pareto" the runs that none beats in both.

    Beaten means: another has no more parameters (a stand-in for the cost of a call) and no larger worst
    error of a long response, and is better in one. Runs that failed, or whose response diverged, are left
    out. Equal errors go to fewer parameters, then to the run_id, so that the choice does not depend on
    the order of `records`; the Pareto set runs from the cheapest to the most accurate.
    """
    selection: dict[str, dict[str, Any]] = {}
    for record in sorted(filter(_usable, records), key=_rank):
        chosen = selection.setdefault(record["variant"], {"pareto": []})
        chosen.setdefault(record["architecture"], dict(record))
        # from the most accurate on: a run belongs to the set if it is cheaper than all before it
        if all(record[COST] < better[COST] for better in chosen["pareto"]):
            chosen["pareto"].append(dict(record))
    for chosen in selection.values():
        chosen["pareto"].reverse()
    return selection


def select_maps(records: Iterable[Record]) -> dict[str, dict[str, Any]]:
    """Under each label the run of a map with the least validation nmse, failed runs left out.

    Labels come in the order of `records`; equal errors go to the first.
    """
    best: dict[str, dict[str, Any]] = {}
    for record in records:
        error = record["validation_nmse"]
        if record["status"] == "finished" and error is not None:
            known = best.get(record["label"])
            if known is None or error < known["validation_nmse"]:
                best[record["label"]] = dict(record)
    return best


def _usable(record: Record) -> bool:
    return record["status"] == "finished" and record.get(ERROR) is not None and not record.get("diverged")


def _rank(record: Record) -> tuple[float, int, str]:
    return record[ERROR], record[COST], record["run_id"]
