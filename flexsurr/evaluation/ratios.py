"""From wall times of single simulations to the cost table: means, spreads, and ratios to three baselines."""

import numpy as np
import pandas as pd

from flexsurr.config.study import Integrator

PAPERS_INTEGRATOR = Integrator(method="scipy_radau")
"""Radau at SciPy's default tolerances: what the paper integrates with."""

SETUP = ["model", "implementation", "integrator"]

BASELINES = ("described", "numpy", "compiled")


def summary(measurements: pd.DataFrame) -> pd.DataFrame:
    """One row per model × implementation × integrator, in order of appearance.

    `measurements` holds one row per simulation (`cost.measurements`). A simulation that diverged is
    counted in `diverged` and in `simulations`; its time and error are left out of every mean, since it
    stopped early, and the row's figures are NaN when none is left.

    - wall_s_mean, wall_s_std: over simulations [s].
    - relative_to_<baseline>_percent: mean over the simulations that both have run of the ratio of wall
      times; relative_to_described_std_percent its spread. The baseline is the reduced model in that
      implementation with SciPy's Radau at default tolerances; for a row with another (compiled)
      integrator, relative_to_compiled_percent takes the compiled reduced model with that same integrator.
    - tip_error_percent, tip_error_2s_percent, energy_drift_percent, own_energy_drift_percent: the worst
      simulation. Standard deviations have one degree of freedom less than simulations; NaN for one.
    """
    finished = measurements[measurements["completed"]]
    walls = {setup: group.set_index("simulation")["wall_s"] for setup, group in finished.groupby(SETUP)}
    rows = []
    for setup, group in measurements.groupby(SETUP, sort=False):
        done = group[group["completed"]]
        model, implementation, integrator = setup
        row = {
            "model": model,
            "implementation": implementation,
            "integrator": integrator,
            "simulations": len(group),
            "wall_s_mean": done["wall_s"].mean(),
            "wall_s_std": done["wall_s"].std(),
        }
        for baseline in BASELINES:
            same = baseline == "compiled" and ("rom", baseline, integrator) in walls
            reference = walls.get(("rom", baseline, integrator if same else PAPERS_INTEGRATOR.label))
            mean, spread = relative_percent(walls.get(setup), reference)
            row[f"relative_to_{baseline}_percent"] = mean
            row[f"relative_to_{baseline}_std_percent"] = spread
        for quality in (
            "tip_error_percent",
            "tip_error_2s_percent",
            "energy_drift_percent",
            "own_energy_drift_percent",
        ):
            row[quality] = done[quality].max()
        row["phase_lag_s"] = done["phase_lag_s"].abs().max()
        row["diverged"] = int((~group["completed"]).sum())
        rows.append(row)
    return pd.DataFrame(rows)


def relative_percent(wall_s: pd.Series | None, baseline_s: pd.Series | None) -> tuple[float, float]:
    """Mean and standard deviation [%] of the ratio of wall times, over the simulations both have run.

    Both series are indexed by the simulation's number. NaN where there is no pair, or only one (spread).
    """
    if wall_s is None or baseline_s is None:
        return float("nan"), float("nan")
    ratio = (100.0 * wall_s / baseline_s).dropna()
    if ratio.empty:
        return float("nan"), float("nan")
    spread = float(np.std(ratio, ddof=1)) if len(ratio) > 1 else float("nan")
    return float(ratio.mean()), spread
