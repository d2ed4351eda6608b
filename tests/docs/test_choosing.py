"""How to choose: what the page shows is what the command prints, and it holds for any scale of time."""

import re
import subprocess
import sys
from pathlib import Path

import pytest
import yaml

from flexsurr.config.study import Study, check_steps

TOP = Path(__file__).parents[2]
PAGE = (TOP / "docs" / "choosing.md").read_text()


def told(*arguments):
    command = [sys.executable, TOP / "examples" / "choose.py", *arguments]
    return subprocess.run(command, cwd=TOP, capture_output=True, text=True, check=True).stdout


def settings(text):
    """The keys that it advises, as a study has them."""
    table = text[text.index("dataset:") : text.index("fastest decay")]
    found = yaml.safe_load(re.sub(r"(judging_integrator: )(\w+)\((.*)\)", r"\1{method: \2, \3}", table))
    values = found["evaluation"]["judging_integrator"]
    pairs = (key.split("=") for key in values if "=" in key)
    return found, values["method"], dict(pairs)


def test_the_page_shows_what_the_command_prints():
    blocks = re.findall(r"^```text\n(.*?)^```", PAGE, re.MULTILINE | re.DOTALL)
    assert told("config/structures/wing.yaml", "--modes", "3") == blocks[0]


@pytest.mark.parametrize("slower", [1.0, 10.0, 1000.0])
def test_times_go_with_the_period_and_make_whole_steps(tmp_path, slower):
    """Mass times k² is every frequency over k: and every time k times as long, to a digit."""
    structure = yaml.safe_load((TOP / "config/structures/cantilever.yaml").read_text())
    structure["mass_per_length_kg_m"] *= slower**2
    path = tmp_path / "slow.yaml"
    path.write_text(yaml.safe_dump(structure))
    found, method, chosen = settings(told(path, "--modes", "1"))
    period = 0.11294 * slower
    dataset, evaluation = found["dataset"], found["evaluation"]
    check_steps(dataset["duration_s"], dataset["step_s"])
    check_steps(evaluation["duration_s"], evaluation["output_step_s"], "output_step_s")
    assert dataset["duration_s"] == pytest.approx(2 * period, rel=0.05)
    assert period / 50 < dataset["step_s"] <= period / 20
    assert period / 25 < evaluation["output_step_s"] <= period / 10
    assert 40 * period < evaluation["duration_s"] <= 100 * period
    assert method == "dop853_fixed"
    assert float(chosen["h"]) == evaluation["output_step_s"]
    Study.model_validate(
        {
            "structure": "slow.yaml",
            "sweeps": {"default": "sweep.yaml"},
            "reduction": {"modes": 1},
            "dataset": dataset,
            "evaluation": {key: evaluation[key] for key in ("duration_s", "output_step_s")},
        }
    )
