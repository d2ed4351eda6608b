"""Three published tasks: what surrogates come to on them, beside what their papers came to.

python benchmarks/published_tasks.py [tasks.csv]

Spring and pendulum: the sweep of config/sweeps/spring.yaml on the noisy trajectories with their exact
derivatives, the states smoothed by the filter's defaults; of each architecture the model whose worst rollout
errs least. Damped spring: config/sweeps/damped_spring.yaml on a grid free of noise, by the validation loss.
Means over five datasets, and of the energy over five sets of initial states.
"""

import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from statistics import fmean

import numpy as np
import pandas as pd

from flexsurr.config.files import Columns, Filter, Rollouts
from flexsurr.config.reading import Source, build, read_yaml
from flexsurr.config.sweep import FieldSweep
from flexsurr.config.trial import Trial
from flexsurr.evaluation.published_tasks import TASKS, Task, energy_mse, grid, rate_mse, recordings
from flexsurr.evaluation.rollouts import HeldOut, HeldOutTrajectories, rollout_errors
from flexsurr.storage.source_files import filtered, read_recordings
from flexsurr.surrogates import Surrogate, compiled
from flexsurr.training import Dataset, fit, split_dataset
from flexsurr.training.sweep import expand

SEEDS = 5
SWEEPS = Path(__file__).resolve().parents[1] / "config" / "sweeps"
COLUMNS = Columns.model_validate(
    {
        "trajectory": "trajectory",
        "pairs": [
            {
                "q": {"column": "q", "unit": "1", "derivative": "dq_dt"},
                "p": {"column": "p", "unit": "1", "derivative": "dp_dt"},
            }
        ],
    }
)
NAMES = {"state_names": COLUMNS.state_names, "state_units": COLUMNS.state_units}
SETTINGS = Rollouts()


def trials(name: str) -> list[Trial]:
    return expand(build(FieldSweep, [Source(name, read_yaml(SWEEPS / name))]))


def surrogates(dataset: Dataset, sweep: str) -> Iterator[Surrogate]:
    for trial in trials(sweep):
        with tempfile.TemporaryDirectory() as folder:
            result = fit(trial, dataset, folder)
        if result.status == "finished":
            yield result.surrogate


def on_trajectories(task: Task, seed: int) -> Iterator[dict[str, object]]:
    """The best of each architecture, by its rollouts beside the second half of the trajectories."""
    with tempfile.TemporaryDirectory() as folder:
        recordings(task, seed).to_csv(Path(folder) / "task.csv", index=False)
        noisy = read_recordings(Path(folder), ["task.csv"], COLUMNS).trajectories
    data = [filtered(recording, Filter()) for recording in noisy]
    half = len(data) // 2
    dataset = split_dataset(
        np.repeat(np.arange(len(data)), [len(each.t) for each in data]),
        np.concatenate([each.x for each in data]),
        np.concatenate([each.dx for each in data]),
        validation=range(half, len(data)),
        **NAMES,
    )
    spread = np.array(dataset.scales.standard_deviation[:2])
    held_out = tuple(HeldOut(k, each.t, each.x) for k, each in enumerate(data[half:], start=half))
    beside = HeldOutTrajectories(held_out[: SETTINGS.trajectories], spread, *NAMES.values())
    best: dict[str, tuple[float, Surrogate]] = {}
    for surrogate in surrogates(dataset, "spring.yaml"):
        error = rollout_errors(surrogate, beside, SETTINGS.integrator)["long_response_error_percent_worst"]
        if error is not None and error < best.get(surrogate.architecture, (np.inf,))[0]:
            best[surrogate.architecture] = error, surrogate
    x, dx = (np.concatenate([getattr(each, name) for each in noisy[half:]]) for name in ("x", "dx"))
    for architecture, (_, surrogate) in best.items():
        yield {
            "task": task.name,
            "architecture": architecture,
            "energy_mse": fmean(
                energy_mse(task, compiled(surrogate), starts, SETTINGS.integrator) for starts in range(SEEDS)
            ),
            "test_loss": rate_mse(surrogate, x, dx),
        }


def on_grid(task: Task, seed: int) -> Iterator[dict[str, object]]:
    """The best of each architecture by its validation loss, on 85 % of the points of a grid."""
    x, dx = grid(task)
    order = np.random.default_rng(seed).permutation(len(x))
    test = order[round(0.85 * len(x)) :]
    dataset = split_dataset(np.arange(len(x)), x, dx, validation=test.tolist(), **NAMES)
    best: dict[str, float] = {}
    for surrogate in surrogates(dataset, "damped_spring.yaml"):
        loss = rate_mse(surrogate, x[test], dx[test])
        best[surrogate.architecture] = min(loss, best.get(surrogate.architecture, np.inf))
    for architecture, loss in best.items():
        yield {"task": task.name, "architecture": architecture, "energy_mse": None, "test_loss": loss}


def main() -> None:
    rows = []
    for task in TASKS.values():
        for seed in range(SEEDS):
            rows += list((on_grid if task.friction else on_trajectories)(task, seed))
            print(task.name, seed, flush=True)
    frame = pd.DataFrame(rows).groupby(["task", "architecture"], sort=False, as_index=False).mean()
    published = [
        TASKS[task].published.get(architecture)
        for task, architecture in zip(frame["task"], frame["architecture"], strict=True)
    ]
    frame = frame.assign(published=published)
    print(frame.to_string(index=False, float_format="{:.1e}".format))
    if len(sys.argv) > 1:
        frame.to_csv(sys.argv[1], index=False, float_format="%.4g")


if __name__ == "__main__":
    main()
