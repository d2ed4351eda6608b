"""What each integrator costs, against RK4: 30 s of a small oscillator at 55 rad/s.

    python benchmarks/integrators.py [--repeats 20]

Ratios of medians measured in turns; absolute times depend on the machine and on what else it does.
"""

# ruff: noqa: E402  (the kernel's own cache has to be named before numba is imported)

import argparse
from functools import partial
from pathlib import Path

import numpy as np

from flexsurr import kernel_cache

kernel_cache.activate(Path(__file__).with_name("oscillator.py"))

from oscillator import OscillatorModel
from timing import compare, measure

from flexsurr.config.study import Integrator
from flexsurr.simulation import simulate

COMPILED = [
    Integrator(method="rk4", step_s=1e-3),
    Integrator(method="dop853_fixed", step_s=2e-2),
    Integrator(method="dop853_fixed", step_s=1e-2),
    Integrator(method="dop853", rtol=1e-7, atol=1e-9),
    Integrator(method="gauss_legendre_4", step_s=2.5e-3),
    Integrator(method="gauss_legendre_6", step_s=5e-3),
    Integrator(method="radau_iia_5", rtol=1e-6, atol=1e-9),
]
SCIPY = [Integrator(method="scipy_radau"), Integrator(method="scipy_dop853", rtol=1e-7, atol=1e-9)]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--repeats", type=int, default=20)
    repeats = parser.parse_args().repeats

    model = OscillatorModel()
    t = np.linspace(0.0, 30.0, 301)  # farther apart than any fixed step
    x0 = np.array([0.3, 0.0])
    runs = {i.label: partial(simulate, model, t, x0, i) for i in COMPILED + SCIPY}
    compiled, scipy = ({i.label: runs[i.label] for i in integrators} for integrators in (COMPILED, SCIPY))
    first = {COMPILED[0].label: runs[COMPILED[0].label]}
    reference = simulate(model, t, x0, Integrator(method="dop853", rtol=1e-13, atol=1e-14)).x
    peak = np.abs(reference).max(axis=0)
    found = {label: run() for label, run in runs.items()}
    errors = {
        label: float((np.abs(each.x[-1] - reference[-1]) / peak).max()) for label, each in found.items()
    }
    timings = compare("30 s of an oscillator", compiled, repeats, errors=errors)
    slow = compare("30 s of an oscillator, SciPy", first | scipy, repeats=3, warmup=1, errors=errors)
    timings |= {label: slow[label] for label in scipy}

    print(
        f"{'integrator':<40}{'30 s in ms':>12}{'± ms':>8}{'calls':>9}{'ns/call':>9}{'of RK4':>8}{'error':>9}"
    )
    for label, timing in timings.items():
        trajectory = found[label]
        print(
            f"{label:<40}{timing.median_s * 1e3:>12.3f}{timing.spread_s * 1e3:>8.3f}"
            f"{trajectory.evaluations:>9}{timing.median_s / trajectory.evaluations * 1e9:>9.1f}"
            f"{timing.ratio:>8.2f}{errors[label]:>9.0e}"
        )
    short = partial(simulate, model, np.array([0.0, 1e-3]), x0, COMPILED[0])
    step = measure("one step of RK4", "through simulate", short, repeats=1000, warmup=10)
    print(f"one step of RK4 through simulate: {step}")


if __name__ == "__main__":
    main()
