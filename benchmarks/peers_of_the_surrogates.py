"""Surrogates of the damped wing, against two libraries that learn the same from the same samples.

    python benchmarks/peers_of_the_surrogates.py  # needs: pip install opinf phlearn

1,000 free responses of the wing, five samples of each; errors on the study's other fifty. opinf fits
polynomials in the states by least squares. phlearn trains a pseudo-Hamiltonian network, a Hamiltonian and
dampers of the momenta, by Adam in torch; states and rates are scaled for it as for ours. Ours are the
port-Hamiltonian polynomial and network. The error of the tip is the largest of 5 s of a fresh free response
over the peak of its displacement; other libraries' models are integrated by SciPy's Radau.
"""

import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import torch
from scipy.integrate import solve_ivp
from timing import compare
from wing import ACCURATE, FRESH, datasets, starts, wing_model

from flexsurr.config.trial import trial_of
from flexsurr.simulation import simulate
from flexsurr.surrogates import compiled
from flexsurr.training import Dataset, fit
from flexsurr.training.losses import nmse

try:
    import opinf
    import phlearn.phnns as phlearn
except ImportError as error:
    print(f"left out: {error}")
    sys.exit(3)


TIMES = np.linspace(0.0, 5.0, 501)
TRAINING_S = 60.0
WIDTH = 64
REPEATS, CALLS = 20, 20
OURS = {
    f"flexsurr, polynomial of degree {degree}": trial_of(
        architecture="port_hamiltonian", degree=degree, optimiser="least_squares"
    )
    for degree in (4, 6, 8)
} | {
    "flexsurr, network of 32": trial_of(
        architecture="port_hamiltonian", hidden=(32,), activation="atan", epochs=100
    )
}
OPINF = ("A", "AH", "AHG")


@dataclass(frozen=True)
class Fitted:
    """A model with its rates at states (n, 6), one at a time or all, and its trajectory from a state."""

    rates: Callable[[np.ndarray], np.ndarray]
    trajectory: Callable[[np.ndarray], np.ndarray]
    training_s: float


def by_radau(rates: Callable[[np.ndarray], np.ndarray]) -> Callable[[np.ndarray], np.ndarray]:
    def trajectory(x0: np.ndarray) -> np.ndarray:
        def derivative(_: float, x: np.ndarray) -> np.ndarray:
            return rates(x[None])[0]

        found = solve_ivp(derivative, (0.0, TIMES[-1]), x0, "Radau", TIMES, rtol=1e-6, atol=1e-8)
        x = np.full((len(TIMES), len(x0)), np.nan)
        x[: found.y.shape[1]] = found.y.T
        return x

    return trajectory


def ours(trial, dataset: Dataset) -> Fitted:
    with tempfile.TemporaryDirectory() as folder:
        result = fit(trial, dataset, folder)
    model = compiled(result.surrogate)

    def rates(x: np.ndarray) -> np.ndarray:
        return np.array([model.derivative(0.0, state) for state in x])

    return Fitted(rates, lambda x0: simulate(model, TIMES, x0, ACCURATE).x, result.wall_s)


def by_opinf(operators: str, dataset: Dataset) -> Fitted:
    begin = time.perf_counter()
    states, rates = scales(dataset)
    model = opinf.models.ContinuousModel(operators)
    model.fit(states=(dataset.x_train / states).T, ddts=(dataset.dx_train / rates).T)
    seconds = time.perf_counter() - begin

    def found(x: np.ndarray) -> np.ndarray:
        return np.array([model.rhs(0.0, state) for state in x / states]) * rates

    return Fitted(found, by_radau(found), seconds)


def by_phlearn(dataset: Dataset) -> Fitted:
    """A network of a given time of training, whole epochs."""
    states, _ = scales(dataset)
    half = len(states) // 2
    canonical = np.block([[np.zeros((half, half)), np.eye(half)], [-np.eye(half), np.zeros((half, half))]])
    torch.manual_seed(0)
    model = phlearn.PseudoHamiltonianNN(
        2 * half,
        skewsymmetric_matrix=torch.tensor(canonical, dtype=torch.float32),
        hamiltonian_est=phlearn.HamiltonianNN(2 * half, WIDTH),
        dissipation_est=phlearn.R_estimator([False] * half + [True] * half),
    )

    def tensor(values: np.ndarray) -> torch.Tensor:
        return torch.tensor(values, dtype=torch.float32)

    x, dx = tensor(dataset.x_train / states), tensor(dataset.dx_train / states)
    zeros = torch.zeros((len(x), 1))
    deviation = dx.std(dim=0)

    def loss(predicted: torch.Tensor, target: torch.Tensor) -> torch.Tensor:
        return torch.mean(((predicted - target) / deviation) ** 2)

    optimiser = torch.optim.Adam(model.parameters(), lr=1e-3)

    def epochs(count: int) -> float:
        begin = time.perf_counter()
        phlearn.train(
            model,
            integrator=False,
            traindata=((x, x, zeros, zeros, zeros + 1.0, zeros), dx),
            optimizer=optimiser,
            epochs=count,
            batch_size=128,
            loss_fn=loss,
            verbose=False,
        )
        return time.perf_counter() - begin

    first = epochs(1)  # torch prepares itself within it
    one = epochs(1)
    seconds = first + one + epochs(max(1, int(TRAINING_S / one)))

    def rates(values: np.ndarray) -> np.ndarray:
        at = tensor(values / states)
        found = model.x_dot(at, torch.zeros((len(at), 1)))
        return found.detach().numpy().astype(float) * states

    return Fitted(rates, by_radau(rates), seconds)


def scales(dataset: Dataset) -> tuple[np.ndarray, np.ndarray]:
    """Of the states, one for all η and one for all p: Hamilton's equations stay theirs. Of the rates."""
    half = dataset.x_train.shape[1] // 2
    reach = np.abs(dataset.x_train).max(axis=0)
    return np.repeat([reach[:half].max(), reach[half:].max()], half), np.std(dataset.dx_train, axis=0)


def main() -> None:
    torch.set_num_threads(1)
    dataset = datasets("hamiltonian")["1,000 x 5"]
    reference = wing_model("hamiltonian")
    start = starts(FRESH, 1)[0]
    exact = simulate(reference, TIMES, start, ACCURATE).x
    at_rest = reference.tip(np.zeros(len(start)))
    peak = np.max(np.linalg.norm(reference.tip(exact) - at_rest, axis=1))
    fitted = {name: ours(trial, dataset) for name, trial in OURS.items()}
    fitted |= {f"opinf, {operators}": by_opinf(operators, dataset) for operators in OPINF}
    fitted[f"phlearn, network of {WIDTH}"] = by_phlearn(dataset)
    few = dataset.x_validation[:CALLS]
    callers = {name: lambda model=model: model.rates(few) for name, model in fitted.items()}
    tips = {name: reference.tip(model.trajectory(start)) for name, model in fitted.items()}
    errors = {
        name: np.max(np.linalg.norm(tip - reference.tip(exact), axis=1)) / peak for name, tip in tips.items()
    }
    timings = compare("rates of the wing from Python", callers, REPEATS, counts=CALLS, errors=errors)
    print(f"{'':<34}{'fit in s':>10}{'nmse':>10}{'tip in 5 s':>12}{'us a call':>12}")
    for name, model in fitted.items():
        error = nmse(model.rates(dataset.x_validation[::10]), dataset.dx_validation[::10])
        distance = errors[name]
        shown = f"{distance:>12.1e}" if np.isfinite(distance) else f"{'diverges':>12}"
        print(
            f"{name:<34}{model.training_s:>10.2f}{error:>10.1e}{shown}{1e6 * timings[name].median_s:>12.1f}",
            flush=True,
        )


if __name__ == "__main__":
    main()
