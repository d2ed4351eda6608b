"""What only the physics can refuse: one line of each command, and no traceback."""

import subprocess
import sys

import pytest
from small_results import PLAN, REPOSITORY, STUDY, VARIANT

from flexsurr.cli.trajectories import simulate
from flexsurr.storage import read_shard
from flexsurr.workflow.job_files import write_job

BUCKLES = {"clamp_theta_deg": 90.0, "gravity_m_s2": 9.81, "bending_stiffness_out_of_plane_N_m2": 0.05}
FILES = {
    "simulate": ["output"],
    "statics": ["statics", "frequencies", "shapes"],
    "validate": ["output"],
    "learn_load": ["manifest", "polynomial", "network", "errors"],
}
JOBS = {
    "simulate": lambda: PLAN.studies[STUDY].simulate(VARIANT, 0),
    "statics": lambda: PLAN.studies[STUDY].statics(),
    "validate": lambda: PLAN.studies[STUDY].validation(),
    "learn_load": lambda: PLAN.studies[STUDY].learn_load(VARIANT),
}


@pytest.mark.parametrize("command", FILES)
def test_a_column_that_buckles_under_its_own_weight(whole, tmp_path, command):
    job = JOBS[command]()
    job["structure"] |= BUCKLES
    job["part"]["reduction"]["about"] = "equilibrium"
    assert "cantilever: buckles under" in refusal(command, job, whole, tmp_path)


def test_a_simulation_that_leaves_the_numbers(whole, tmp_path):
    """Large momenta: the trajectory ends, its shard says so, and a dataset of such is refused."""
    job = JOBS["simulate"]()
    job["part"]["dataset"]["initial_conditions"]["p_max_kg_m2_s"] = 1e100
    simulate(job, tmp_path / "shard-0000.parquet")
    shard = read_shard(tmp_path / "shard-0000.parquet")
    assert len(shard.metadata.failures) == shard.metadata.count
    job["part"]["dataset"]["initial_conditions"]["p_max_kg_m2_s"] = 1e200
    assert "trajectory 0: its initial state is too large" in refusal("simulate", job, whole, tmp_path)


def refusal(command, job, whole, tmp_path) -> str:
    """The one line by which a command refuses its job."""
    words = [sys.executable, "-m", "flexsurr", command.replace("_", "-")]
    words += ["--job", str(write_job(tmp_path, command, job))]
    for file in FILES[command]:
        words += [
            f"--{file}",
            str(whole.dataset / "manifest.json" if file == "manifest" else tmp_path / file),
        ]
    done = subprocess.run(words, cwd=REPOSITORY, capture_output=True, text=True, timeout=300)
    assert done.returncode == 1
    assert "Traceback" not in done.stderr
    (line,) = [line for line in done.stderr.splitlines() if line.startswith("flexsurr ")]
    return line
