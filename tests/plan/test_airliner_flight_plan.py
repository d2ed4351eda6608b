"""The jobs that fly the airliner: what they hold, and what a command makes of it."""

import json
from pathlib import Path

from flexsurr.cli.flight import airliner_of, selected_networks
from flexsurr.config.settings import load
from flexsurr.workflow.plan import Plan

ROOT = Path(__file__).resolve().parents[2]


def test_a_job_is_plain_data_from_which_the_airliner_comes_back():
    plan = Plan(load(ROOT, ["config/config.yaml"]))
    study = plan.studies["airliner"].resolved
    job = json.loads(json.dumps(plan.studies["airliner"].fly()))
    airliner = airliner_of(job)
    assert airliner.settings == study.study.flight
    assert airliner.limits == study.limits
    assert airliner.modes.model.aircraft == study.aircraft
    panels = study.study.dataset.panels
    assert (
        len(airliner.airframe.lattice)
        == 2 * (panels.wing[0] * panels.wing[1] + panels.horizontal_tail[0] * panels.horizontal_tail[1])
        + panels.vertical_tail[0] * panels.vertical_tail[1]
    )
    assert job["boundary_condition"] == study.study.dataset.boundary_condition


def test_a_selection_without_a_network_has_none_to_fly_with(tmp_path: Path):
    selection = tmp_path / "airliner.json"
    selection.write_text(json.dumps({"linear": {"run_id": "linear-0", "architecture": "linear"}}))
    assert selected_networks(selection, tmp_path) == {}
