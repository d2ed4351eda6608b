"""Data of a nonlinear oscillator with a known Hamiltonian: H = p² / (2 M(q)) + ½ K q², M = 0.18 + 0.1 q²."""

import numpy as np
from scipy.integrate import solve_ivp

from flexsurr.surrogates import HNN, MLP, DissipativeHNN, Network, canonical_scaling
from flexsurr.training import Dataset, split_dataset
from flexsurr.training.initialisation import initial_parameters

STIFFNESS = 555.0
NAMES, UNITS = ("eta_1", "p_1"), ("1", "kg m2/s")
FORMS: dict[str, type[Network]] = {"hnn": HNN, "mlp": MLP, "dissipative_hnn": DissipativeHNN}


def field(x):
    """ẋ (..., 2) at x (..., 2)."""
    q, p = x[..., 0], x[..., 1]
    mass = 0.18 + 0.1 * q**2
    return np.stack([p / mass, 0.1 * q * p**2 / mass**2 - STIFFNESS * q], axis=-1)


def free_responses(trajectories=8, samples=40, seed=0) -> Dataset:
    """Free responses over two periods from random states; a quarter of them, at least one, validate."""
    generator = np.random.default_rng(seed)
    t = np.linspace(0.0, 0.2, samples)
    starts = generator.uniform([-0.35, 0.0], [0.35, 1.5], (trajectories, 2))
    x = np.concatenate(
        [
            solve_ivp(lambda t, x: field(x), (0.0, t[-1]), start, "DOP853", t, rtol=1e-10, atol=1e-12).y.T
            for start in starts
        ]
    )
    return split_dataset(
        np.repeat(np.arange(trajectories), samples),
        x,
        field(x),
        validation=range(0, trajectories, 4),
        state_names=NAMES,
        state_units=UNITS,
    )


def network(dataset: Dataset, architecture="hnn", hidden=(6,), activation="softplus", seed=0) -> Network:
    """A network with random weights for the states of `dataset`."""
    form = FORMS[architecture]
    return form(
        initial_parameters(form, len(dataset.state_names), hidden, "wide", seed),
        canonical_scaling(dataset.scales),
        dataset.state_names,
        dataset.state_units,
        hidden,
        activation,
    )


def three_pairs(samples=60, seed=0) -> Dataset:
    """Samples of random states and rates of three pairs (q, p); no system behind them."""
    generator = np.random.default_rng(seed)
    names = tuple(f"{kind}_{k}" for kind in ("eta", "p") for k in range(3))
    return split_dataset(
        np.arange(samples) % 4,
        generator.normal(size=(samples, 6)),
        generator.normal(size=(samples, 6)),
        validation=[0],
        state_names=names,
        state_units=("1",) * 6,
    )
