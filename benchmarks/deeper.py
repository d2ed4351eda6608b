"""Whether a second hidden layer pays for a mass matrix of many modes: docs/crossover.md.

Networks of M's packed entries with one layer and with two, of about as many products a call, by one
optimiser (torch's L-BFGS) on the same configurations of the canonical wing; beside them one layer as flexsurr
trains it. An error of an entry counts as it does there. Run: python benchmarks/deeper.py
"""

from itertools import pairwise

import numpy as np
import torch
from intrinsic import STARTS, basis

from flexsurr.surrogates.packed import pack
from flexsurr.training.configuration_samples import configuration_samples
from flexsurr.training.initialisation import initial_weights
from flexsurr.training.levenberg_marquardt import LevenbergMarquardt
from flexsurr.training.one_hidden_layer import OneHiddenLayer
from flexsurr.training.port_hamiltonian_training import _by_effect

MODES, SAMPLES, ITERATIONS, EPOCHS, SEEDS = 8, 2000, 1000, 300, 3
LAYERS = ((16,), (12, 12), (32,), (20, 20))


def squareplus(z):
    return 0.5 * (z + torch.sqrt(z * z + 1.0))


def products(sizes) -> int:
    """Of one right-hand side: each weight once forwards and once back."""
    return 2 * sum(a * b for a, b in pairwise(sizes))


def fitted(x, y, weights, hidden, seed) -> float:
    """The weighted mean squared error on what is held out, a fifth."""
    torch.manual_seed(seed)
    sizes = (x.shape[1], *hidden, y.shape[1])
    layers = [torch.nn.Linear(a, b) for a, b in pairwise(sizes)]
    network = torch.nn.ModuleList(layers)

    def error(part):
        values = x[part]
        for layer in layers[:-1]:
            values = squareplus(layer(values))
        return ((layers[-1](values) - y[part]) ** 2).mean(0) @ weights

    training, held_out = slice(len(x) // 5, None), slice(len(x) // 5)
    method = torch.optim.LBFGS(
        network.parameters(), max_iter=ITERATIONS, history_size=50, line_search_fn="strong_wolfe"
    )

    def closure():
        method.zero_grad()
        loss = error(training)
        loss.backward()
        return loss

    method.step(closure)
    with torch.no_grad():
        return float(error(held_out))


def by_levenberg_marquardt(x, y, weights, hidden, seed) -> float:
    """The same of one layer, as a network of a mass matrix is trained."""
    training, held_out = slice(len(x) // 5, None), slice(len(x) // 5)
    objective, judge = (
        OneHiddenLayer.of_map(x[part], y[part], hidden, "squareplus", weights)
        for part in (training, held_out)
    )
    start = initial_weights(x.shape[1], hidden, y.shape[1], seed, spread=1.0)
    method = LevenbergMarquardt(objective, start)
    for _ in range(EPOCHS):
        if method.finished:
            break
        method.epoch()
    return judge.loss(method.parameters)


def main() -> None:
    """Print the table."""
    torch.set_default_dtype(torch.float64)
    samples = configuration_samples(basis(MODES), "hamiltonian", STARTS, SAMPLES)
    q, mass = samples.x_train[:, :MODES], samples.mass
    weights = _by_effect(mass)
    x, y = q / q.std(axis=0), pack(mass)
    spread = y.std(axis=0)
    y, weights = (y - y.mean(axis=0)) / spread, weights * spread**2
    in_torch = [torch.tensor(each) for each in (x, y, weights)]
    print("| hidden layers | products | by L-BFGS | by Levenberg–Marquardt |\n|---|---|---|---|")
    for hidden in LAYERS:
        found = [min(fitted(*in_torch, hidden, seed) for seed in range(SEEDS))]
        if len(hidden) == 1:
            found.append(min(by_levenberg_marquardt(x, y, weights, *hidden, seed) for seed in range(SEEDS)))
        row = [str(hidden), str(products((MODES, *hidden, y.shape[1])))]
        row += [f"{np.sqrt(each):.1e}" for each in found] + [""] * (2 - len(found))
        print("|", " | ".join(row), "|", flush=True)


if __name__ == "__main__":
    main()
