"""Adam and AdamW over mini-batches, torch's own, for any torch module on any device."""

import math

import numpy as np
import torch

from flexsurr.simulation.rhs import Array
from flexsurr.training.torch_objective import TorchObjective

MOMENTS = ("exp_avg", "exp_avg_sq")


class TorchAdam:
    """torch.optim.Adam, or with a `weight_decay` AdamW, at a constant rate or half a cosine over `epochs`.

    An epoch takes the samples in the order that the compiled `Adam` takes them in. Satisfies `Optimiser`.
    """

    finished = ""

    def __init__(
        self,
        objective: TorchObjective,
        *,
        learning_rate: float,
        batch_size: int,
        epochs: int,
        cosine: bool,
        weight_decay: float | None,
        seed: int,
    ) -> None:
        self._objective = objective
        self._learning_rate, self._batch_size = learning_rate, batch_size
        self._epochs, self._cosine, self._seed = epochs, cosine, seed
        self._torch: torch.optim.Optimizer = (
            torch.optim.Adam(objective.weights, lr=learning_rate)
            if weight_decay is None
            else torch.optim.AdamW(objective.weights, lr=learning_rate, weight_decay=weight_decay)
        )
        self._done = 0

    @property
    def parameters(self) -> Array:
        """The weights."""
        return self._objective.parameters

    def epoch(self) -> float:
        """One pass over the samples; the mean of the batches' losses."""
        objective = self._objective
        objective.module.train()
        if self._cosine:
            rate = self._learning_rate * 0.5 * (1.0 + math.cos(math.pi * self._done / self._epochs))
            for group in self._torch.param_groups:
                group["lr"] = rate
        # order and dropout are functions of seed and epoch: a resumed run needs no state of a generator
        order = np.random.default_rng([self._seed, self._done]).permutation(len(objective.x))
        total = torch.zeros((), dtype=torch.float64, device=objective.x.device)
        with torch.random.fork_rng():
            torch.manual_seed(int(np.random.SeedSequence([self._seed, self._done]).generate_state(1)[0]))
            for samples in torch.from_numpy(order).split(self._batch_size):
                loss, gradients = objective.of_batch(samples)
                for weight, gradient in zip(objective.weights, gradients, strict=True):
                    weight.grad = gradient
                self._torch.step()
                total += len(samples) * loss
        self._done += 1
        return float(total) / len(order)

    def state(self) -> dict[str, Array]:
        """Weights, both moments and the numbers of epochs and steps."""
        states = [self._torch.state[weight] for weight in self._objective.weights]
        moments = {
            name: torch.cat([state[name].reshape(-1) for state in states]).cpu().numpy() for name in MOMENTS
        }
        steps = np.array([float(state["step"]) for state in states])
        return {"parameters": self.parameters, "done": np.array(self._done), "steps": steps, **moments}

    def restore(self, state: dict[str, Array]) -> None:
        """Go on from a `state`."""
        self._objective.parameters = state["parameters"]
        self._done = int(state["done"])
        first = 0
        for weight, step in zip(self._objective.weights, state["steps"], strict=True):
            piece = slice(first, first + weight.numel())
            moments = {
                name: torch.from_numpy(state[name][piece].copy()).to(weight).view_as(weight)
                for name in MOMENTS
            }
            self._torch.state[weight] = {"step": torch.tensor(step, dtype=torch.float32), **moments}
            first = piece.stop
