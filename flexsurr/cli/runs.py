"""What is written of a run as keys with values (fit.json, metrics.json), and the choice among runs."""

from pathlib import Path
from typing import Any

from flexsurr.storage import DamagedFile, read_json

OF_A_RUN = ("run_id", "study", "status")


def read_run(path: Path) -> dict[str, Any]:
    """What a file in a run's folder says of it; DamagedFile for a damaged one, or another run's."""
    content = read_json(path, OF_A_RUN)
    if content["run_id"] != path.parent.name:
        raise DamagedFile(f"{path}: another run's: that of {content['run_id']}")
    return content


def read_selection(path: Path) -> dict[str, dict[str, Any]]:
    """Variant -> name -> what is written of the chosen run, and under "pareto" a list of such.

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
