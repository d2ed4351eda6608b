"""What the library comes to on the published tasks, against what their papers came to.

`python benchmarks/published_tasks.py` has the means over several datasets.
"""

import numpy as np
import pytest

from flexsurr.config.files import Columns, Filter
from flexsurr.config.study import Integrator
from flexsurr.config.trial import trial_of
from flexsurr.evaluation.published_tasks import (
    DAMPED_SPRING,
    PENDULUM,
    SPRING,
    energy_mse,
    grid,
    rate_mse,
    recordings,
)
from flexsurr.storage.source_files import filtered, read_recordings
from flexsurr.surrogates import compiled
from flexsurr.training import fit, split_dataset

STATES = {"state_names": ("q", "p"), "state_units": ("1", "1")}
INTEGRATOR = Integrator(method="rk4", step_s=0.005)
NETWORK = {"hidden": (3,), "activation": "squareplus", "epochs": 300, "patience": 40}
PAIR = {name: {"column": name, "unit": "1", "derivative": f"d{name}_dt"} for name in ("q", "p")}
COLUMNS = Columns.model_validate({"trajectory": "trajectory", "pairs": [PAIR]})


def learned(trial, dataset, folder):
    return fit(trial_of(**trial), dataset, folder).surrogate


@pytest.mark.parametrize("task", [SPRING, PENDULUM], ids=lambda task: task.name)
def test_an_hnn_keeps_energy_better_than_its_first_paper(task, tmp_path):
    recordings(task, seed=0).to_csv(tmp_path / "task.csv", index=False)
    smooth = [
        filtered(each, Filter()) for each in read_recordings(tmp_path, ["task.csv"], COLUMNS).trajectories
    ]
    dataset = split_dataset(
        np.repeat(np.arange(50), task.samples),
        np.concatenate([each.x for each in smooth]),
        np.concatenate([each.dx for each in smooth]),
        validation=range(25, 50),
        **STATES,
    )
    surrogate = learned(NETWORK | {"architecture": "hnn"}, dataset, tmp_path)
    found = np.mean([energy_mse(task, compiled(surrogate), seed, INTEGRATOR) for seed in range(3)])
    assert found < task.published["hnn"]


def test_a_d_hnn_learns_the_damped_spring_better_than_its_first_paper(tmp_path):
    x, dx = grid(DAMPED_SPRING)
    test = np.random.default_rng(0).permutation(len(x))[530:]
    dataset = split_dataset(np.arange(len(x)), x, dx, validation=test.tolist(), **STATES)
    wider = {"architecture": "dissipative_hnn", "hidden": (8,), "activation": "tanh"}
    surrogate = learned(NETWORK | wider, dataset, tmp_path)
    assert rate_mse(surrogate, x[test], dx[test]) < DAMPED_SPRING.published["dissipative_hnn"]
