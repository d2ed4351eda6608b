"""Port-Hamiltonian networks: derivatives of their residuals, and what trains them."""

from dataclasses import fields, replace

import numpy as np
import pytest

from flexsurr.config.trial import trial_of
from flexsurr.surrogates import PairScaling, PolynomialPortHamiltonian, load, save
from flexsurr.training import fit, nmse, split_dataset
from flexsurr.training.configuration_samples import ConfigurationSamples
from flexsurr.training.inverse_dynamics import channel_spread
from flexsurr.training.port_hamiltonian_training import PortHamiltonianObjective, untrained_port_hamiltonian

NAMES = ("eta_1", "eta_2", "p_1", "p_2")
TRIAL = trial_of(architecture="port_hamiltonian", hidden=(6,), activation="atan", epochs=70)
ENTRIES = trial_of(**TRIAL.model_dump(), mass_matrix="entries")


def samples(odd: float, number=240, seed=0):
    """Of a damped system of two coordinates; `odd` makes its mass matrix uneven in q."""
    exponents = np.array([[0, 0], [1, 0], [0, 1], [2, 0], [1, 1], [0, 2]])
    mass = np.zeros((3, 6))
    mass[:, 0] = [1.0, 0.2, 0.7]
    mass[:, 3] = [0.1, -0.2, 0.3]
    mass[:, 5] = [0.2, 0.05, -0.1]
    mass[:, 1] = odd
    truth = PolynomialPortHamiltonian(
        np.concatenate([mass.ravel(), [2.0, 0.3, 5.0], [0.3, -0.2, 0.5]]),
        PairScaling(q=(0.3, 2.0), action=1.5, energy=60.0),
        NAMES,
        ("1",) * 4,
        exponents,
    )
    x = np.random.default_rng(seed).uniform(-1.0, 1.0, (number, 4)) * truth.scaling.states(4)
    return split_dataset(
        np.arange(number) % 4,
        x,
        truth.derivative(0.0, x),
        validation=[0],
        state_names=NAMES,
        state_units=("1",) * 4,
    )


EVEN, ODD = samples(0.0), samples(0.1)


def objective_of(dataset, forward):
    network = untrained_port_hamiltonian(dataset, (4,), "atan", 1)
    return PortHamiltonianObjective.of(network, dataset.x_train, dataset.dx_train, forward)


def residuals(objective, parameters):
    """In plain NumPy: of the field, or of the momenta and forces at the measured rates."""
    model = replace(objective.network, parameters=parameters)
    q, p = objective.x[:, :2], objective.x[:, 2:]
    if objective.forward:
        return (model.scaled_field(objective.x) - objective.y) * objective.roots
    rates, forces = objective.y[:, :2], objective.y[:, 2:]
    momenta = np.einsum("sij,sj->si", model.scaled_mass(q), rates)
    gyroscopic = np.einsum("skij,si,sj->sk", model.scaled_mass_derivatives(q), rates, rates)
    found = 0.5 * gyroscopic - q @ model.scaled_stiffness - rates @ model.scaled_damping
    return np.concatenate([momenta - p, found - forces], axis=1) * objective.roots


@pytest.mark.parametrize("dataset", [EVEN, ODD], ids=["even", "odd"])
@pytest.mark.parametrize("forward", [False, True], ids=["inverse", "forward"])
def test_normal_equations(dataset, forward, monkeypatch):
    """Against differences of the residuals, in pieces smaller than the samples."""
    objective = objective_of(dataset, forward)
    assert objective.network.even == (dataset is EVEN)
    parameters = objective.network.parameters
    monkeypatch.setattr("flexsurr.training.port_hamiltonian_training.CHUNK", 28 * parameters.size)
    columns = []
    for e in np.eye(parameters.size):
        d = [
            (residuals(objective, parameters + h * e) - residuals(objective, parameters - h * e)) / (2 * h)
            for h in (1e-3, 2e-3)
        ]
        columns.append(((4 * d[0] - d[1]) / 3).ravel())
    jacobian = np.stack(columns, axis=1)
    errors = residuals(objective, parameters).ravel()
    found = objective.normal_equations(parameters)
    gram, gradient = jacobian.T @ jacobian, jacobian.T @ errors
    np.testing.assert_allclose(found.gram, gram, atol=1e-8 * np.max(np.abs(gram)))
    np.testing.assert_allclose(found.gradient, gradient, atol=1e-8 * np.max(np.abs(gradient)))
    assert found.loss == pytest.approx(errors @ errors) == pytest.approx(objective.loss(parameters))
    step = 1e-2 * np.random.default_rng(2).normal(size=parameters.size)
    around = (residuals(objective, parameters + sign * step).ravel() for sign in (1.0, -1.0))
    second = sum(around) - 2.0 * errors
    bent = objective.bend(parameters, step)
    np.testing.assert_allclose(bent, jacobian.T @ second, atol=1e-2 * np.max(np.abs(bent)))


def test_the_forward_loss_is_the_nmse():
    objective = objective_of(ODD, True)
    expected = nmse(objective.network.derivative(0.0, ODD.x_train), ODD.dx_train)
    assert objective.loss(objective.network.parameters) == pytest.approx(expected)
    spread = channel_spread(objective.network.scaling, ODD.scales)
    weights = (objective_of(ODD, False).roots * spread) ** 2
    np.testing.assert_allclose(weights, 1.0 / (4 * len(ODD.x_train)))


def test_it_learns(tmp_path):
    result = fit(TRIAL, EVEN, tmp_path)
    assert result.status == "finished"
    assert result.validation_nmse < 1e-5
    assert result.surrogate.even
    np.testing.assert_allclose(result.surrogate.stiffness[0, 0], 2.0 * 60.0 / 0.3**2, rtol=1e-3)
    save(result.surrogate, tmp_path / "weights.npz")
    np.testing.assert_array_equal(load(tmp_path / "weights.npz").parameters, result.surrogate.parameters)


@pytest.mark.parametrize("dataset", [EVEN, ODD], ids=["even", "odd"])
def test_the_entries_of_the_mass_matrix_are_learned_far_more_accurately(dataset, tmp_path):
    factored, entries = (fit(trial, dataset, tmp_path) for trial in (TRIAL, ENTRIES))
    assert entries.status == "finished"
    assert entries.surrogate.even == (dataset is EVEN)
    assert entries.validation_nmse < 0.02 * factored.validation_nmse
    assert entries.validation_nmse == pytest.approx(
        nmse(entries.surrogate.derivative(0.0, dataset.x_validation), dataset.dx_validation)
    )
    assert entries.validation_nmse == pytest.approx(entries.history["validation_loss"].min())
    save(entries.surrogate, tmp_path / "weights.npz")
    again = load(tmp_path / "weights.npz")
    x = dataset.x_validation
    np.testing.assert_array_equal(again.derivative(0.0, x), entries.surrogate.derivative(0.0, x))


def with_mass(mass):
    """The samples of EVEN with this matrix `mass` (2, 2) at every configuration."""
    masses = np.broadcast_to(mass, (len(EVEN.x_train), 2, 2)).copy()
    known = {field.name: getattr(EVEN, field.name) for field in fields(EVEN)}
    matrices = {"stiffness": np.eye(2), "damping": 0.1 * np.eye(2)}
    return ConfigurationSamples(
        **known, mass=masses, forces=-EVEN.x_train[:, :2], mirrors=np.empty((0, 2)), **matrices
    )


def test_where_the_mass_matrix_is_known_it_is_what_is_learned(tmp_path):
    """One that does not vary too; springs and dampers are those of the samples, whose rates are others."""
    mass = np.array([[2.0, 0.3], [0.3, 1.0]])
    surrogate = fit(ENTRIES.model_copy(update={"keep": "last"}), with_mass(mass), tmp_path).surrogate
    np.testing.assert_allclose(surrogate.mass_matrix(EVEN.x_train[:, :2]), with_mass(mass).mass, rtol=1e-6)
    np.testing.assert_allclose(surrogate.stiffness, np.eye(2), rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(surrogate.damping, 0.1 * np.eye(2), rtol=1e-12, atol=1e-12)


def test_a_mass_matrix_that_is_not_positive_definite_has_failed(tmp_path):
    result = fit(ENTRIES, with_mass(np.diag([1.0, -0.5])), tmp_path)
    assert result.status == "failed"
    assert "mass matrix of the network is not positive definite at q = (" in result.reason


def test_killed_and_resumed_the_entries_are_as_uninterrupted(tmp_path, monkeypatch):
    trial = ENTRIES.model_copy(update={"epochs": 12})
    expected = fit(trial, ODD, tmp_path / "whole")
    monkeypatch.setattr("flexsurr.training.epochs.CHECKPOINT_EVERY_S", 0.0)

    def kill(epoch, *_):
        if epoch == 6:
            raise Killed

    with pytest.raises(Killed):
        fit(trial, ODD, tmp_path / "killed", kill)
    found = fit(trial, ODD, tmp_path / "killed")
    np.testing.assert_array_equal(found.surrogate.parameters, expected.surrogate.parameters)


class Killed(Exception):
    """Stands for the end of a process."""


def test_killed_in_either_stage_and_resumed_is_as_uninterrupted(tmp_path, monkeypatch):
    monkeypatch.setattr("flexsurr.training.port_hamiltonian_training.INVERSE_EPOCHS", 5)
    trial = TRIAL.model_copy(update={"epochs": 12})
    expected = fit(trial, EVEN, tmp_path / "whole")
    monkeypatch.setattr("flexsurr.training.epochs.CHECKPOINT_EVERY_S", 0.0)
    for last in (3, 6, 9):

        def kill(epoch, *_, last=last):
            if epoch == last:
                raise Killed

        with pytest.raises(Killed):
            fit(trial, EVEN, tmp_path / "killed", kill)
    found = fit(trial, EVEN, tmp_path / "killed")
    np.testing.assert_array_equal(found.surrogate.parameters, expected.surrogate.parameters)
    losses = ["train_loss", "validation_loss"]
    np.testing.assert_array_equal(found.history[losses], expected.history[losses])
