"""A short beam, a short study of it, and surrogates whose quality is known beforehand."""

import numpy as np
import pytest

from flexsurr.beam import draw_initial_conditions, reduce, reduced_order
from flexsurr.config.structure import Structure
from flexsurr.config.study import (
    DescribedSimulations,
    EvaluationSettings,
    Integrator,
    Reduction,
    Statics,
    Study,
)
from flexsurr.simulation import simulate
from flexsurr.storage import Scales
from flexsurr.surrogates import PolynomialHamiltonian, canonical_scaling

TIGHT = Integrator(method="rk4", step_s=1e-4)
"""Exact to ten digits for this beam, and of all integrators the one that is compiled soonest."""


@pytest.fixture(scope="session")
def structure():
    return Structure(
        name="cantilever",
        length_m=1.0,
        elements=4,
        joints=("out_of_plane",),
        mass_per_length_kg_m=0.2,
        bending_stiffness_out_of_plane_N_m2=50.0,
    )


@pytest.fixture(scope="session")
def study():
    return Study(
        structure="none",
        sweeps={"default": "none"},
        reduction=Reduction(modes=1),
        evaluation=EvaluationSettings(
            simulations=3,
            described_simulations=DescribedSimulations(hamiltonian=1),
            scipy_simulations=2,
            duration_s=0.3,
            output_step_s=0.01,
            repeats=2,
            long_responses=2,
            longest_load_s=0.2,
            validation_duration_s=0.5,
            reference_integrator=TIGHT,
            judging_integrator=TIGHT,
            drawing_integrator=TIGHT,
            energy_integrator=TIGHT,
            validation_integrator=TIGHT,
            # by other steps, which need no other machine code
            integrators=(
                Integrator(method="rk4", step_s=2e-4),
                Integrator(method="rk4", step_s=1e-3),
            ),
        ),
        statics=Statics(tip_loads_N=(0.0, 100.0, 20.0)),
    )


@pytest.fixture(scope="session")
def basis(structure, study):
    return reduce(structure, study.reduction)


@pytest.fixture(scope="session")
def fitted(study, basis):
    """The polynomial Hamiltonian of the variant that has one: as good as the reference itself."""
    model = reduced_order(basis, "hamiltonian", "compiled")
    starts = draw_initial_conditions(basis, study.dataset.initial_conditions, study.seed, 0, 20)
    x = np.concatenate([simulate(model, np.linspace(0.0, 0.1, 51), x0, TIGHT).x for x0 in starts])
    dx = np.array([model.derivative(0.0, state) for state in x])
    exponents = np.array([(i, 2) for i in range(0, 9, 2)] + [(i, 0) for i in range(2, 11, 2)])
    scaling = canonical_scaling(Scales.of(x, dx))

    def surrogate(coefficients):
        return PolynomialHamiltonian(coefficients, scaling, model.state_names, model.state_units, exponents)

    columns = [
        (surrogate(unit).derivative(0.0, x) / dx.std(axis=0)).ravel() for unit in np.eye(len(exponents))
    ]
    return surrogate(np.linalg.lstsq(np.stack(columns, axis=1), (dx / dx.std(axis=0)).ravel())[0])


@pytest.fixture(scope="session")
def exploding(fitted):
    """H = ½p² − q⁴ in scaled states: escapes to infinity in finite time."""
    exponents = np.array([(0, 2), (4, 0)])
    return PolynomialHamiltonian(
        np.array([0.5, -10.0]), fitted.scaling, fitted.state_names, fitted.state_units, exponents
    )
