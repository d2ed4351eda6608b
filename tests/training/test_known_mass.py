"""Mass matrices that are known: every entry by itself, with every monomial or with few."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from test_configuration_samples import known
from test_inverse_dynamics import R, truth_of

from flexsurr.beam import reduce
from flexsurr.config.study import InitialConditions, Reduction
from flexsurr.config.study_files import read_structure
from flexsurr.config.trial import trial_of
from flexsurr.surrogates import compiled, load, pair_scaling, save
from flexsurr.training import fit, nmse
from flexsurr.training.configuration_samples import configuration_samples
from flexsurr.training.inverse_dynamics import fit_port_hamiltonian
from flexsurr.training.known_mass import SeparateEntries, parities, with_constant

WING = read_structure(Path(__file__).parents[2] / "config/structures/hale_wing.yaml").model_copy(
    update={"elements": 6}
)
RANGES = InitialConditions(
    q_min_deg=-10.0, q_max_deg=10.0, p_min_kg_m2_s=0.0, p_max_kg_m2_s=0.0, higher_modes="as_forced"
)


@pytest.fixture(scope="module")
def samples():
    """Of four modes: two of bending, one of torsion, one in the plane."""
    return configuration_samples(
        reduce(WING, Reduction(modes=4, normalisation="mass")), "hamiltonian", RANGES, 400
    )


@pytest.mark.parametrize("even", [True, False])
def test_entry_by_entry_a_polynomial_is_found_to_rounding(even):
    truth = truth_of(5, even=even, damped=True)
    samples = known(truth)
    found = SeparateEntries(4, pair_scaling(samples.scales), samples, None).solve(even)
    np.testing.assert_allclose(found.mass_matrix(samples.x_train[:, :R]), samples.mass, rtol=1e-9)
    for name in ("stiffness", "damping"):
        np.testing.assert_allclose(getattr(found, name), getattr(truth, name), atol=1e-10)


def test_many_unknowns_are_fitted_entry_by_entry(samples, monkeypatch):
    together = fit_port_hamiltonian(samples, 4)
    monkeypatch.setattr("flexsurr.training.inverse_dynamics.LARGEST_TOGETHER", 10)
    apart = fit_port_hamiltonian(samples, 4)
    errors = [
        nmse(found.derivative(0.0, samples.x_validation), samples.dx_validation)
        for found in (together, apart)
    ]
    assert errors[1] < 10.0 * errors[0]


def test_monomials_of_an_entry_change_their_sign_as_it_does():
    """Of θ, ψ, φ with planes (+, −, −) and (−, +, −): M_θψ has φ and θψ, M_θθ has θ² and θψφ, and so on."""
    exponents = with_constant(3, 3)
    mirrors = np.array([[1.0, -1.0, -1.0], [-1.0, 1.0, -1.0]])
    found = {
        int(entry): {tuple(row) for row in exponents[monomials].tolist()}
        for monomials, entries in parities(exponents, mirrors)
        for entry in entries
    }
    squares = {(0, 0, 0), (2, 0, 0), (0, 2, 0), (0, 0, 2), (1, 1, 1)}
    assert found[0] == found[2] == found[5] == squares
    assert found[1] >= {(0, 0, 1), (1, 1, 0)}
    assert not found[1] & squares
    assert sum(map(len, (found[0], found[1], found[3], found[4]))) == len(exponents)


def test_without_mirrors_every_monomial_is_of_every_entry():
    ((monomials, entries),) = parities(with_constant(3, 3), np.empty((0, 3)))
    assert (len(monomials), len(entries)) == (20, 6)


def test_few_monomials_are_about_as_accurate(samples):
    full, sparse = fit_port_hamiltonian(samples, 4), fit_port_hamiltonian(samples, 4, sparse=True)
    used = [np.count_nonzero(found.parameters[: -2 * found.packed_size]) for found in (full, sparse)]
    assert used[1] < 0.25 * used[0]
    errors = [
        nmse(found.derivative(0.0, samples.x_validation), samples.dx_validation) for found in (full, sparse)
    ]
    assert errors[1] < 30.0 * errors[0]
    assert errors[1] < 1e-5


def test_a_sparse_fit_is_compiled_and_kept(samples, tmp_path):
    found = fit_port_hamiltonian(samples, 4, sparse=True)
    save(found, tmp_path / "weights.npz")
    again = load(tmp_path / "weights.npz")
    x = samples.x_validation[:5]
    expected = found.derivative(0.0, x)
    model = compiled(again)
    rates = np.array([model.derivative(0.0, state) for state in x])
    np.testing.assert_allclose(rates, expected, rtol=1e-9, atol=1e-9 * np.abs(expected).max())


def test_masses_that_are_none_are_a_failure_with_a_reason(samples, tmp_path):
    turned = replace(samples, mass=-samples.mass)
    trial = trial_of(
        architecture="port_hamiltonian",
        degree=2,
        terms="sparse",
        configurations=400,
        optimiser="least_squares",
    )
    result = fit(trial, turned, tmp_path)
    assert result.status == "failed"
    assert "not positive definite at q = (" in result.reason


def test_mirrored_neurons_learn_it_with_fewer(samples, tmp_path):
    """With as many numbers to read for each entry, and the symmetry of the mass matrix exactly."""
    common = {
        "architecture": "port_hamiltonian",
        "configurations": 400,
        "hidden": (6,),
        "activation": "squareplus",
        "epochs": 60,
    }
    plain, mirrored = (
        fit(trial_of(**common, mass_matrix=kind), samples, tmp_path / kind)
        for kind in ("entries", "mirrored")
    )
    assert mirrored.status == "finished"
    assert mirrored.validation_nmse < 0.05 * plain.validation_nmse
    surrogate = mirrored.surrogate
    q = samples.x_validation[:3, :4]
    for signs in samples.mirrors:
        image = signs[:, None] * surrogate.mass_matrix(q) * signs
        np.testing.assert_allclose(surrogate.mass_matrix(signs * q), image, rtol=1e-10, atol=1e-12)


@pytest.mark.parametrize(
    ("values", "reason"),
    [
        (
            {"degree": 4, "terms": "sparse", "optimiser": "least_squares"},
            "'sparse' takes port_hamiltonian and",
        ),
        (
            {"hidden": (4,), "activation": "atan", "mass_matrix": "mirrored"},
            "'mirrored' is not allowed without",
        ),
    ],
)
def test_both_need_a_matrix_that_is_known(values, reason):
    with pytest.raises(ValueError, match=reason):
        trial_of(architecture="port_hamiltonian", **values)
