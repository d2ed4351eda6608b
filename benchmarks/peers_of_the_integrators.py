"""Integrators that keep the energy, against diffrax: 30 s of a small oscillator at 55 rad/s.

    python benchmarks/peers_of_the_integrators.py  # needs: pip install diffrax

The mass of the oscillator depends on its coordinate, as of a surrogate of one mode: kinetic and potential
energy are not apart, and splitting methods do not apply. diffrax's steps are compiled by jax, in
double precision. Errors are of the state after 30 s, and the largest change of the energy, over their sizes.
"""

# ruff: noqa: E402  (the kernel's own cache has to be named before numba is imported)

import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np

from flexsurr import kernel_cache

kernel_cache.activate(Path(__file__).with_name("oscillator.py"))

from oscillator import Oscillator, OscillatorModel
from timing import compare

from flexsurr.config.study import Integrator
from flexsurr.simulation import simulate

try:
    import diffrax
    import jax
except ImportError as error:
    print(f"left out: {error}")
    sys.exit(3)

jax.config.update("jax_enable_x64", True)

DURATION_S, SAMPLES, REPEATS = 30.0, 301, 5
TIMES = np.linspace(0.0, DURATION_S, SAMPLES)
START = np.array([0.3, 0.0])
OURS = {
    f"flexsurr, {label}": Integrator(method=method, step_s=step_s)
    for label, method, step_s in (
        ("Gauss-Legendre 6, step 0.005 s", "gauss_legendre_6", 5e-3),
        ("Gauss-Legendre 4, step 0.0025 s", "gauss_legendre_4", 2.5e-3),
        ("DOP853, step 0.01 s", "dop853_fixed", 1e-2),
    )
}
THEIRS = {
    "diffrax, leapfrog midpoint, step 0.0001 s": (diffrax.LeapfrogMidpoint, 1e-4),
    "diffrax, leapfrog midpoint, step 2e-05 s": (diffrax.LeapfrogMidpoint, 2e-5),
    "diffrax, reversible Heun, step 0.0001 s": (diffrax.ReversibleHeun, 1e-4),
    "diffrax, Dopri8, step 0.01 s": (diffrax.Dopri8, 1e-2),
}


def energy(kernel: Oscillator, x: np.ndarray) -> np.ndarray:
    q, p = x[:, 0] ** 2, x[:, 1] ** 2
    return 0.5 * p * (1.0 + kernel.alpha * q) + 0.5 * kernel.omega**2 * q * (1.0 + kernel.beta * q)


def by_diffrax(kernel: Oscillator, solver, step_s: float) -> Callable[[], np.ndarray]:
    """A call that integrates and gives the states (m, 2)."""
    omega, alpha, beta = kernel

    def field(t, x, args):
        q, p = x
        square = q * q
        return jax.numpy.stack(
            [p * (1.0 + alpha * square), -alpha * q * p * p - omega**2 * q * (1.0 + 2.0 * beta * square)]
        )

    @jax.jit
    def solve(start):
        return diffrax.diffeqsolve(
            diffrax.ODETerm(field),
            solver(),
            t0=0.0,
            t1=DURATION_S,
            dt0=step_s,
            y0=start,
            saveat=diffrax.SaveAt(ts=TIMES),
            max_steps=None,
        ).ys

    return lambda: np.asarray(solve(START))


def main() -> None:
    model = OscillatorModel()
    runs: dict[str, Callable[[], np.ndarray]] = {
        name: lambda integrator=integrator: simulate(model, TIMES, START, integrator).x
        for name, integrator in OURS.items()
    }
    runs |= {name: by_diffrax(model.kernel, *settings) for name, settings in THEIRS.items()}
    exact = simulate(model, TIMES, START, Integrator(method="dop853", rtol=1e-13, atol=1e-14)).x[-1]
    found = {name: run() for name, run in runs.items()}
    errors = {name: (np.abs(x[-1] - exact) / np.abs(x).max(axis=0)).max() for name, x in found.items()}
    energies = {name: energy(model.kernel, x) for name, x in found.items()}
    drifts = {name: float(np.ptp(values) / values[0]) for name, values in energies.items()}
    more = {name: {"energy_drift": drift} for name, drift in drifts.items()}
    timings = compare("30 s of an oscillator, energy kept", runs, REPEATS, errors=errors, more=more)
    print(f"{'':<44}{'30 s':>18}{'times':>8}{'error':>9}{'energy':>9}")
    for name, timing in timings.items():
        shown = f"{timing!s:>18}{timing.ratio:>8.3g}{errors[name]:>9.0e}{drifts[name]:>9.0e}"
        print(f"{name:<44}{shown}", flush=True)


if __name__ == "__main__":
    main()
