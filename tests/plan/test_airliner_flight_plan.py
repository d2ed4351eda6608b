"""The jobs that fly the airliner: what they hold, and what a command makes of it."""

import json
from pathlib import Path

import pytest

from flexsurr.cli.flying import airliner_of, selected_networks
from flexsurr.config.airliner import AirlinerFiles, load_airliner
from flexsurr.storage import StorageError
from flexsurr.workflow.airliner_flight_plan import flight_job

ROOT = Path(__file__).resolve().parents[2]


def test_a_job_is_plain_data_from_which_the_airliner_comes_back():
    files = load_airliner(ROOT, AirlinerFiles())
    job = json.loads(json.dumps(flight_job(files)))
    plane = airliner_of(job)
    assert plane.settings == files.flight
    assert plane.limits == files.limits
    assert plane.modes.model.aircraft == files.aircraft
    panels = files.sweep.dataset.panels
    assert (
        len(plane.airframe.lattice)
        == 2 * (panels.wing[0] * panels.wing[1] + panels.horizontal_tail[0] * panels.horizontal_tail[1])
        + panels.vertical_tail[0] * panels.vertical_tail[1]
    )
    assert job["boundary_condition"] == files.sweep.dataset.boundary_condition


def test_a_selection_without_a_network_is_refused(tmp_path: Path):
    selection = tmp_path / "airliner.json"
    selection.write_text(json.dumps({"linear": {"run_id": "airliner-linear-0"}}))
    with pytest.raises(StorageError, match="names no network"):
        selected_networks(selection, tmp_path)
