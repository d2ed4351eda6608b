"""L-BFGS over all samples in double precision: torch's, with the closed-form gradient."""

import math
from typing import Protocol

import numpy as np
import torch

from flexsurr.simulation.rhs import Array

HISTORY = 50
LISTS = ("old_dirs", "old_stps", "ro")


class Differentiable(Protocol):
    """What L-BFGS minimises."""

    def loss(self, parameters: Array) -> float:
        """The loss over all samples."""
        ...

    def gradient(self, parameters: Array, gradient: Array) -> float:
        """The same, its gradient written into `gradient`."""
        ...


class LBFGS:
    """One iteration with a strong Wolfe line search is one epoch. Satisfies `Optimiser`."""

    def __init__(self, objective: Differentiable, parameters: Array) -> None:
        torch.set_num_threads(1)  # a trial is a job among others
        self.parameters = parameters.copy()
        self.finished = ""
        self._objective = objective
        self._weights = torch.from_numpy(self.parameters).requires_grad_()
        self._weights.grad = torch.zeros_like(self._weights)
        self._gradient = self._weights.grad.numpy()
        self._loss()  # compiles; an epoch's time is then its own
        self._torch = torch.optim.LBFGS(
            [self._weights],
            max_iter=1,
            max_eval=25,
            history_size=HISTORY,
            line_search_fn="strong_wolfe",
            tolerance_grad=0.0,
            tolerance_change=0.0,
        )

    def _loss(self) -> float:
        return self._objective.gradient(self.parameters, self._gradient)

    def epoch(self) -> float:
        """One iteration; the loss after it."""
        before = self.parameters.copy()
        self._torch.step(self._loss)
        if np.array_equal(before, self.parameters):
            self.finished = "no step lessens the loss"
        return self._objective.loss(self.parameters)

    def state(self) -> dict[str, Array]:
        """Weights and torch's memory of past steps."""
        memory = self._torch.state[self._weights]
        arrays = {"parameters": self.parameters}
        for name, value in memory.items():
            if name in LISTS:
                arrays[name] = np.array([v.numpy() for v in value])
            elif isinstance(value, torch.Tensor):
                arrays[name] = value.numpy()
            elif isinstance(value, int | float) and math.isfinite(value):
                arrays[name] = np.array(value)
        return arrays

    def restore(self, state: dict[str, Array]) -> None:
        """Go on from a `state`."""
        self.parameters[:] = state["parameters"]
        memory = self._torch.state[self._weights]
        for name, value in state.items():
            if name in LISTS:
                memory[name] = [torch.tensor(v) for v in value]
            elif name != "parameters":
                memory[name] = torch.tensor(value) if value.ndim or name == "H_diag" else value.item()
