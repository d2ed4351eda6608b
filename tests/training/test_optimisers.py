"""Levenberg–Marquardt on problems with known solutions; Adam and L-BFGS against torch's own loops."""

import numpy as np
import pytest
import torch
from oscillator import free_responses, network

from flexsurr.surrogates.torch_module import field
from flexsurr.training.adam import Adam
from flexsurr.training.lbfgs import LBFGS
from flexsurr.training.levenberg_marquardt import LevenbergMarquardt, NormalEquations
from flexsurr.training.networks import from_torch, to_torch
from flexsurr.training.objective import Objective


class Residuals:
    """A sum of squares from residuals and their Jacobian."""

    def __init__(self, residuals, jacobian):
        self.residuals, self.jacobian = residuals, jacobian
        self.linearisations = 0

    def loss(self, parameters):
        r = self.residuals(parameters)
        return float(r @ r)

    def normal_equations(self, parameters):
        self.linearisations += 1
        r, j = self.residuals(parameters), self.jacobian(parameters)
        return NormalEquations(float(r @ r), j.T @ j, j.T @ r)


def test_levenberg_marquardt_solves_a_linear_problem():
    """Columns of very different sizes: the first step goes to the solution but for the damping."""
    generator = np.random.default_rng(0)
    matrix = generator.normal(size=(30, 5)) * np.geomspace(1e-6, 1e6, 5)
    right = generator.normal(size=30)
    solution = np.linalg.lstsq(matrix, right)[0]
    optimiser = LevenbergMarquardt(Residuals(lambda x: matrix @ x - right, lambda x: matrix), np.zeros(5))
    optimiser.epoch()
    assert np.linalg.norm(optimiser.parameters / solution - 1.0) < 0.1
    for _ in range(8):
        optimiser.epoch()
    np.testing.assert_allclose(optimiser.parameters, solution, rtol=1e-6)


def rosenbrock():
    return Residuals(
        lambda x: np.array([10.0 * (x[1] - x[0] ** 2), 1.0 - x[0]]),
        lambda x: np.array([[-20.0 * x[0], 10.0], [-1.0, 0.0]]),
    )


def test_levenberg_marquardt_goes_along_rosenbrocks_valley():
    problem = rosenbrock()
    optimiser = LevenbergMarquardt(problem, np.array([-1.2, 1.0]))
    losses = [optimiser.epoch() for _ in range(40) if not optimiser.finished]
    np.testing.assert_allclose(optimiser.parameters, 1.0, atol=1e-10)
    assert np.all(np.diff(losses) <= 0.0)


class BendingRosenbrock(Residuals):
    """Its first residual bends: its second derivative along a step v is −20 v₀²."""

    def __init__(self):
        plain = rosenbrock()
        super().__init__(plain.residuals, plain.jacobian)

    def bend(self, parameters, step):
        return self.jacobian(parameters).T @ np.array([-20.0 * step[0] ** 2, 0.0])


def test_a_step_that_bends_with_the_residuals_goes_along_the_valley_sooner():
    def epochs(problem):
        optimiser = LevenbergMarquardt(problem, np.array([-1.2, 1.0]))
        losses = [optimiser.epoch() for _ in range(40)]
        assert np.all(np.diff(losses) <= 0.0)
        np.testing.assert_allclose(optimiser.parameters, 1.0, atol=1e-8)
        return np.argmax(np.array(losses) < 1e-12)

    assert epochs(BendingRosenbrock()) < 0.75 * epochs(rosenbrock())


def test_a_step_that_would_bend_too_far_does_not_bend(monkeypatch):
    monkeypatch.setattr("flexsurr.training.levenberg_marquardt.LARGEST_BEND", 0.0)
    bent, plain = (
        LevenbergMarquardt(problem, np.array([-1.2, 1.0])) for problem in (BendingRosenbrock(), rosenbrock())
    )
    for _ in range(5):
        assert bent.epoch() == plain.epoch()


def test_levenberg_marquardt_repeats_steps_from_the_same_jacobian():
    problem = rosenbrock()
    optimiser = LevenbergMarquardt(problem, np.array([-1.2, 1.0]))
    for accepted in range(1, 8):
        optimiser.epoch()
        assert problem.linearisations == 1 + accepted


def test_levenberg_marquardt_does_not_depend_on_units():
    """A parameter in other units: the same path, in those units."""
    units = np.array([1.0, 1024.0])
    problem = rosenbrock()
    scaled = Residuals(lambda x: problem.residuals(x / units), lambda x: problem.jacobian(x / units) / units)
    one = LevenbergMarquardt(problem, np.array([-1.2, 1.0]))
    other = LevenbergMarquardt(scaled, np.array([-1.2, 1.0]) * units)
    for _ in range(10):
        assert other.epoch() == pytest.approx(one.epoch(), rel=1e-6)
        np.testing.assert_allclose(other.parameters, one.parameters * units, rtol=1e-6)


def test_levenberg_marquardt_damps_by_the_largest_diagonal_met():
    problem = rosenbrock()
    optimiser = LevenbergMarquardt(problem, np.array([-1.2, 1.0]))
    largest = problem.normal_equations(optimiser.parameters).gram.diagonal()
    for _ in range(10):
        optimiser.epoch()
        largest = np.maximum(largest, problem.normal_equations(optimiser.parameters).gram.diagonal())
    np.testing.assert_array_equal(optimiser.state()["largest"], largest)
    assert np.any(largest > problem.normal_equations(optimiser.parameters).gram.diagonal())


def test_levenberg_marquardt_notices_its_end():
    """Powell's singular function has a singular JᵀJ at its minimum."""
    root5, root10 = np.sqrt(5.0), np.sqrt(10.0)
    problem = Residuals(
        lambda x: np.array(
            [x[0] + 10 * x[1], root5 * (x[2] - x[3]), (x[1] - 2 * x[2]) ** 2, root10 * (x[0] - x[3]) ** 2]
        ),
        lambda x: np.array(
            [
                [1, 10, 0, 0],
                [0, 0, root5, -root5],
                [0, 2 * (x[1] - 2 * x[2]), -4 * (x[1] - 2 * x[2]), 0],
                [2 * root10 * (x[0] - x[3]), 0, 0, -2 * root10 * (x[0] - x[3])],
            ]
        ),
    )
    optimiser = LevenbergMarquardt(problem, np.array([3.0, -1.0, 0.0, 1.0]))
    for _ in range(500):
        if optimiser.finished:
            break
        loss = optimiser.epoch()
    assert optimiser.finished or loss < 1e-30
    assert loss < 1e-12


DATASET = free_responses(4, 25)


def torchs_own_loop(surrogate, objective, epochs, rate, batch, cosine, weight_decay=0.0):
    """The study's loop: autograd twice, torch.optim.Adam, mean squared error; batches in Adam's order."""
    module = to_torch(surrogate)
    optimiser = torch.optim.AdamW(module.parameters(), lr=rate, weight_decay=weight_decay)
    schedule = torch.optim.lr_scheduler.CosineAnnealingLR(optimiser, epochs if cosine else 10**12)
    x, y = torch.from_numpy(objective.x), torch.from_numpy(objective.y)
    weights = torch.from_numpy(objective.output_weights)
    for epoch in range(epochs):
        order = np.random.default_rng([0, epoch]).permutation(len(x))
        for start in range(0, len(x), batch):
            chosen = order[start : start + batch]
            rates = field(module, x[chosen], create_graph=True)
            loss = (((rates - y[chosen]) ** 2).mean(dim=0) * weights).sum()
            optimiser.zero_grad()
            loss.backward()
            optimiser.step()
        schedule.step()
    return from_torch(module, surrogate).parameters


@pytest.mark.parametrize("decay", [0.0, 0.3])
@pytest.mark.parametrize("cosine", [False, True])
@pytest.mark.parametrize("architecture", ["hnn", "mlp"])
def test_adam_is_torchs(architecture, cosine, decay):
    """AdamW without a decay is Adam."""
    surrogate = network(DATASET, architecture, (8,))
    objective = Objective.of(surrogate, DATASET.x_train, DATASET.dx_train)
    settings = {"learning_rate": 3e-3, "batch_size": 16, "epochs": 4, "cosine": cosine, "seed": 0}
    settings |= {"weight_decay": decay}
    optimiser = Adam(objective, surrogate.parameters, **settings, precision="double")
    for _ in range(4):
        optimiser.epoch()
    expected = torchs_own_loop(surrogate, objective, 4, 3e-3, 16, cosine, decay)
    np.testing.assert_allclose(optimiser.parameters, expected, rtol=1e-9, atol=1e-11)
    single = Adam(objective, surrogate.parameters, **settings, precision="single")
    for _ in range(4):
        single.epoch()
    assert single.parameters.dtype == np.float32
    np.testing.assert_allclose(single.parameters, expected, rtol=1e-3, atol=1e-4)


def test_adam_goes_through_every_sample_once():
    """The batches' losses, weighted by their sizes, are the loss where the rate is nothing."""
    surrogate = network(DATASET, "hnn", (8,))
    objective = Objective.of(surrogate, DATASET.x_train, DATASET.dx_train)
    settings = {"batch_size": 16, "epochs": 1, "cosine": False, "precision": "double", "seed": 0}
    assert len(objective.x) % 16 != 0
    optimiser = Adam(objective, surrogate.parameters, learning_rate=1e-300, **settings)
    assert optimiser.epoch() == pytest.approx(objective.loss(surrogate.parameters), rel=1e-12)


def test_lbfgs_is_torchs():
    surrogate = network(DATASET, "hnn", (8,))
    objective = Objective.of(surrogate, DATASET.x_train, DATASET.dx_train)
    optimiser = LBFGS(objective, surrogate.parameters)
    losses = [optimiser.epoch() for _ in range(12)]
    assert np.all(np.diff(losses) < 0.0)

    module = to_torch(surrogate)
    x, y = torch.from_numpy(objective.x), torch.from_numpy(objective.y)
    weights = torch.from_numpy(objective.output_weights)
    reference = torch.optim.LBFGS(
        module.parameters(), max_iter=12, max_eval=300, history_size=50, line_search_fn="strong_wolfe"
    )

    def closure():
        reference.zero_grad()
        loss = (((field(module, x, create_graph=True) - y) ** 2).mean(dim=0) * weights).sum()
        loss.backward()
        return loss

    reference.step(closure)
    np.testing.assert_allclose(
        optimiser.parameters, from_torch(module, surrogate).parameters, rtol=1e-5, atol=1e-6
    )
