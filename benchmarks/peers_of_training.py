"""Training of the cantilever's Hamiltonian network, against torch's own loop: Adam and L-BFGS.

    OMP_NUM_THREADS=1 python benchmarks/peers_of_training.py

The same network, H = Σ c σ(W x + b) of 16 neurons, the same samples in the same scales, the same loss, one
thread. In torch the field is the gradient of H by autograd, as Hamiltonian networks are written there;
weights start as `nn.Linear` draws them, and the loop has a fixed time of the processor. Adam is tried with
torch's own rate and with ten times that, in single precision; L-BFGS sees all samples, in double. What
validation takes is counted for ours alone. Beside the times to a mark stands the lowest nmse of the rates on
held-out trajectories within the time.
"""

import itertools
import tempfile
import time
from collections.abc import Callable, Iterator

import numpy as np
import torch
from cantilever import cantilever_dataset
from timing import record
from torch import nn

from flexsurr.config.trial import trial_of
from flexsurr.surrogates.torch_module import field
from flexsurr.training import Dataset, fit, nmse
from flexsurr.training.losses import output_weights

NEURONS, SEED = 16, 0
BUDGET_S = 30.0
MARKS = (1e-4, 1e-5, 1e-6, 1e-8)
OURS = "flexsurr, Levenberg-Marquardt"
TRIAL = trial_of(
    architecture="hnn",
    hidden=(NEURONS,),
    activation="half_log",
    epochs=100_000,
    time_limit_s=BUDGET_S,
    seed=SEED,
)
ADAM = {  # learning rate, samples in a batch
    "torch, Adam, rate 0.001, batches of 64": (1e-3, 64),
    "torch, Adam, rate 0.01, batches of 64": (1e-2, 64),
    "torch, Adam, rate 0.01, batches of 1,024": (1e-2, 1024),
}
LBFGS = "torch, L-BFGS"

History = list[tuple[float, float]]
"""Seconds of the processor and the nmse of validation, as training goes on."""


class Hamiltonian(nn.Module):
    """Scaled H (batch, 1) of scaled states (batch, 2)."""

    def __init__(self) -> None:
        super().__init__()
        self.hidden = nn.Linear(2, NEURONS)
        self.readout = nn.Linear(NEURONS, 1, bias=False)

    def forward(self, x: torch.Tensor) -> torch.Tensor:
        return self.readout(0.5 * torch.log1p(self.hidden(x) ** 2))


def ours(dataset: Dataset) -> tuple[History, np.ndarray, np.ndarray]:
    """What Levenberg-Marquardt came to, and the scales of states and rates that it was given."""
    with tempfile.TemporaryDirectory() as folder:
        result = fit(TRIAL, dataset, folder)
    scaling, count = result.surrogate.scaling, dataset.x_train.shape[1]
    found = zip(result.history.processor_s, result.history.validation_loss, strict=True)
    return list(found), scaling.states(count), scaling.rates(count)


def in_torch(
    dataset: Dataset, states: np.ndarray, rates: np.ndarray, rate: float | None, batch: int
) -> History:
    """By Adam at this rate; where there is none, by L-BFGS."""
    number = torch.float64 if rate is None else torch.float32
    torch.manual_seed(SEED)
    module = Hamiltonian().to(number)
    x = torch.tensor(dataset.x_train / states, dtype=number)
    dx = torch.tensor(dataset.dx_train / rates, dtype=number)
    weights = torch.tensor(output_weights(dataset.dx_train / rates), dtype=number)
    held_out = torch.tensor(dataset.x_validation / states, dtype=number)

    def loss(at: torch.Tensor, target: torch.Tensor) -> torch.Tensor:
        return (((field(module, at, create_graph=True) - target) ** 2).mean(dim=0) * weights).sum()

    if rate is None:
        steps = by_lbfgs(module, lambda: loss(x, dx))
    else:
        steps = by_adam(module, rate, lambda chosen: loss(x[chosen], dx[chosen]), len(x), batch)
    loss(x[:8], dx[:8]).backward()  # torch prepares itself within its first
    history, spent = [], 0.0
    while spent < BUDGET_S:
        begin = time.process_time()
        next(steps)
        spent += time.process_time() - begin
        found = field(module, held_out).detach().numpy().astype(float) * rates
        history.append((spent, nmse(found, dataset.dx_validation)))
    return history


def by_adam(module: nn.Module, rate: float, loss: Callable, samples: int, batch: int) -> Iterator[None]:
    """Some steps at a time, so that validation sees more than ends of epochs."""
    optimiser = torch.optim.Adam(module.parameters(), lr=rate)
    epochs = itertools.chain.from_iterable(torch.randperm(samples).split(batch) for _ in itertools.count())
    for number, chosen in enumerate(epochs, 1):
        optimiser.zero_grad()
        loss(chosen).backward()
        optimiser.step()
        if number % 100 == 0:
            yield


def by_lbfgs(module: nn.Module, loss: Callable) -> Iterator[None]:
    """A call, of up to twenty iterations, at a time."""
    optimiser = torch.optim.LBFGS(module.parameters(), line_search_fn="strong_wolfe")

    def closure() -> torch.Tensor:
        optimiser.zero_grad()
        found = loss()
        found.backward()
        return found

    while True:
        optimiser.step(closure)
        yield


def main() -> None:
    torch.set_num_threads(1)
    dataset = cantilever_dataset("hamiltonian")
    found, states, rates = ours(dataset)
    histories = {OURS: found}
    for name, (rate, batch) in ADAM.items():
        histories[name] = in_torch(dataset, states, rates, rate, batch)
    histories[LBFGS] = in_torch(dataset, states, rates, None, 0)
    lowest = {name: min(loss for _, loss in history) for name, history in histories.items()}
    more = {name: {"nmse": loss} for name, loss in lowest.items()}
    print(
        f"{'s of the processor to an nmse of':<44}"
        + "".join(f"{mark:>10.0e}" for mark in MARKS)
        + "    lowest"
    )
    reached = {
        mark: {
            name: next((s for s, loss in history if loss <= mark), None)
            for name, history in histories.items()
        }
        for mark in MARKS
    }
    for name in histories:
        times = [reached[mark][name] for mark in MARKS]
        cells = "".join(f"{'–' if s is None else f'{s:.2f}':>10}" for s in times)
        print(f"{name:<44}{cells}{lowest[name]:>10.0e}", flush=True)
    for mark, seconds in reached.items():
        record(f"a Hamiltonian network of {NEURONS} to a validation nmse of {mark:.0e}", seconds, more=more)


if __name__ == "__main__":
    main()
