"""Radau IIA with the Jacobians that surrogates bring, beside the same by finite differences.

    python benchmarks/jacobians.py

Of the damped wing with 3 modes, 30 s, and of the crossover's canonical wing, which is not damped, with 3, 8
and 10 modes, 2 s: at the default tolerances of the wing's study and at its tight ones. All are fitted without
a simulation, and timed in turns: one Jacobian, then the responses, with their evaluations.
"""

import tempfile
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from intrinsic import STARTS
from intrinsic import basis as canonical_basis
from numba import njit
from timing import Timing, compare
from wing import basis as wing_basis

from flexsurr.beam import draw_initial_conditions
from flexsurr.config.study import InitialConditions, Integrator
from flexsurr.config.trial import trial_of
from flexsurr.simulation import implements_rhs, jacobian, rhs, simulate
from flexsurr.surrogates import compiled
from flexsurr.training import fit
from flexsurr.training.configuration_samples import configuration_samples

INTEGRATORS = [
    Integrator(method="radau_iia_5", rtol=rtol, atol=atol) for rtol, atol in ((1e-3, 1e-6), (1e-7, 1e-9))
]
SAMPLES, SEED, FRESH = 2000, 2024, 100_000
JACOBIANS, REPEATS = 1000, 15
PASSIVE = {"architecture": "port_hamiltonian", "configurations": SAMPLES}
SQUARES = PASSIVE | {"optimiser": "least_squares"}
FULL = SQUARES | {"degree": 4}
SPARSE = FULL | {"terms": "sparse"}
NETWORK = PASSIVE | {"epochs": 100, "hidden": (12,)}
OF_WING = {
    "polynomial, degree 4": FULL,
    "polynomial, degree 6": FULL | {"degree": 6},
    "sparse, degree 4": SPARSE,
    "sparse, degree 6": SPARSE | {"degree": 6},
    "network of entries, 12 atan": NETWORK | {"mass_matrix": "entries", "activation": "atan"},
    "mirrored network, 12 squareplus": NETWORK | {"mass_matrix": "mirrored", "activation": "squareplus"},
}
CANONICAL_MODES = (3, 8, 10)


class ByDifferences(NamedTuple):
    """The equations of a kernel, without its Jacobian."""

    model: Any


@implements_rhs(ByDifferences)
def _by_differences(kernel, t, x, dx, work):
    rhs(kernel.model, t, x, dx, work)


@dataclass(frozen=True, eq=False)
class WithoutJacobian:
    """A compiled model whose Jacobian is left to finite differences."""

    model: Any
    breakpoints: tuple[float, ...] = ()

    @property
    def kernel(self) -> NamedTuple:
        return ByDifferences(self.model.kernel)

    def __getattr__(self, name: str) -> Any:
        return getattr(self.model, name)


@njit(error_model="numpy")
def jacobians(kernel, x, dx, jac, work, times):
    """One Jacobian, `times` over."""
    for _ in range(times):
        jacobian(kernel, 0.0, x, dx, jac, work)


def one_jacobian(surrogate: str, forms: dict[str, Any], x: Any) -> dict[str, Timing]:
    """Seconds of one at the state x, of each form."""
    dx, jac = next(iter(forms.values())).derivative(0.0, x), np.empty((x.size, x.size))

    def repeated(model):
        jacobians(model.kernel, x, dx, jac, np.empty(model.work_size), JACOBIANS)

    runs = {form: partial(repeated, model) for form, model in forms.items()}
    more = {form: {"surrogate": surrogate} for form in forms}
    return compare(f"Jacobian of {surrogate}", runs, REPEATS, counts=JACOBIANS, more=more)


def of_structure(name: str, basis: Any, ranges: InitialConditions, trials: dict[str, Any], t: Any) -> None:
    """Time all surrogates of one structure."""
    samples = configuration_samples(basis, "hamiltonian", ranges, SAMPLES)
    (x0,) = draw_initial_conditions(basis, ranges, SEED, FRESH, 1)
    for label, settings in trials.items():
        surrogate = f"{name}, {label}"
        with tempfile.TemporaryDirectory() as folder:
            model = compiled(fit(trial_of(**settings), samples, Path(folder)).surrogate)
        forms = {"differences": WithoutJacobian(model), "analytic": model}
        alone = one_jacobian(surrogate, forms, x0)
        row = f"| {surrogate} | {alone['differences']} | {alone['analytic']} |"
        for integrator in INTEGRATORS:
            more = {
                form: {
                    "surrogate": surrogate,
                    "rtol": integrator.rtol,
                    "evaluations": simulate(each, t, x0, integrator).evaluations,
                }
                for form, each in forms.items()
            }
            runs = {form: partial(simulate, each, t, x0, integrator) for form, each in forms.items()}
            timings = compare(f"{t[-1]:g} s of {surrogate}, {integrator.label}", runs, REPEATS, more=more)
            counts, own = [form["evaluations"] for form in more.values()], timings["analytic"]
            row += f" {counts[0]} → {counts[1]} | {timings['differences']} → {own} |"
            row += f" {own.ratio:.3f} ± {own.ratio_spread:.1g} |"
        print(row, flush=True)


def main() -> None:
    """Print the table."""
    print("| surrogate | by differences | analytic |" + " evaluations | response | ratio |" * 2)
    print("|---" * 9 + "|")
    t = np.linspace(0.0, 30.0, 3001)
    of_structure("wing, r = 3", wing_basis(), InitialConditions(), OF_WING, t)
    for modes in CANONICAL_MODES:
        name = f"canonical wing, r = {modes}"
        of_structure(name, canonical_basis(modes), STARTS, {"sparse, degree 4": SPARSE}, t[:201])


if __name__ == "__main__":
    main()
