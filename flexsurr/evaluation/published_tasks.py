"""Three published tasks: an ideal spring, an ideal pendulum, a damped spring, and what their papers came to.

- *spring* and *pendulum*: Greydanus, Dzamba and Yosinski, Hamiltonian Neural Networks, NeurIPS 2019, tasks 1
  and 2, as their repository greydanus/hamiltonian-nn has them: H = q² + p², and H = 3(1 − cos q) + p²; fifty
  trajectories over 3 s, of 30 and 45 samples, half of them to train on; Gaussian noise of 0.1 on the states,
  exact derivatives. `energy_mse` is theirs.
- *damped_spring*: Sosanya and Greydanus, Dissipative Hamiltonian Neural Networks, 2022 (arXiv 2201.10085), as
  their repository DrewSosa/dissipative_hnns has it: H = q² + p² and −ρ q in q̇, with ρ = 2; no trajectories,
  but the states of a grid of 25 × 25, 85 % to train on, free of noise. `rate_mse` is theirs.

Everything is in the papers' units, which are none.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd

from flexsurr.config.study import Integrator
from flexsurr.simulation import simulate
from flexsurr.simulation.rhs import Array, Model

DURATION_S = 3.0
TRAJECTORIES = 50
NOISE = 0.1

TIGHT = Integrator(method="scipy_dop853", rtol=1e-10, atol=1e-12)

# What models are scored by: free responses of 20 s from fifteen states, q and p of 0.2 to 1 either way.
STARTS = 15
LONG_S = 20.0
LONG_SAMPLES = 100

GRID = 25
GRID_EDGE = 1.2


@dataclass(frozen=True)
class Task:
    """q̇ = ∂H/∂p − `friction` q, ṗ = −∂H/∂q; satisfies `Model`.

    `slope` is ∂H/∂q of q, while ∂H/∂p = 2 p. Initial states have lengths of `radii` in every direction.
    `published` is what its paper came to by architecture: of `energy_mse`, or of `rate_mse` where there is
    friction.
    """

    name: str
    slope: Callable[[Array], Array]
    radii: tuple[float, float]
    samples: int
    published: Mapping[str, float]
    friction: float = 0.0
    state_names: tuple[str, ...] = ("q", "p")
    state_units: tuple[str, ...] = ("1", "1")
    breakpoints: tuple[float, ...] = ()

    def derivative(self, t: float, x: Array) -> Array:
        """ẋ (..., 2) at states x (..., 2)."""
        q, p = x[..., 0], x[..., 1]
        return np.stack([2.0 * p - self.friction * q, -self.slope(q)], axis=-1)


def _spring(q: Array) -> Array:
    return 2.0 * q


def _pendulum(q: Array) -> Array:
    return 3.0 * np.sin(q)


SPRING = Task("spring", _spring, (0.1, 1.0), 30, {"mlp": 1.7077e-1, "hnn": 3.8416e-4})
PENDULUM = Task("pendulum", _pendulum, (1.3, 2.3), 45, {"mlp": 4.1519e-2, "hnn": 2.4852e-2})
# The last test losses that the authors' notebook prints, at step 4,800 of 5,000; the mean of its last five is
# 9.86e-5 for the MLP, 0.626 for the HNN and 5.75e-5 for the D-HNN.
DAMPED_SPRING = Task(
    "damped_spring", _spring, (0.1, 1.0), 30, {"mlp": 2.08e-5, "hnn": 0.625, "dissipative_hnn": 2.10e-5}, 2.0
)
TASKS = {task.name: task for task in (SPRING, PENDULUM, DAMPED_SPRING)}


def recordings(
    task: Task, seed: int, trajectories: int = TRAJECTORIES, samples: int | None = None
) -> pd.DataFrame:
    """Noisy states and exact derivatives: columns trajectory, t, q, p, dq_dt, dp_dt.

    `samples` a trajectory, the task's own where None.
    """
    generator = np.random.default_rng(seed)
    t = np.linspace(0.0, DURATION_S, samples or task.samples)
    frames = []
    for number in range(trajectories):
        direction = generator.uniform(-1.0, 1.0, size=2)
        start = generator.uniform(*task.radii) * direction / np.linalg.norm(direction)
        x = simulate(task, t, start, TIGHT).x
        (q, p), (dq, dp) = (x + NOISE * generator.normal(size=x.shape)).T, task.derivative(0.0, x).T
        columns = {"trajectory": number, "t": t, "q": q, "p": p, "dq_dt": dq, "dp_dt": dp}
        frames.append(pd.DataFrame(columns))
    return pd.concat(frames, ignore_index=True)


def grid(task: Task) -> tuple[Array, Array]:
    """States x (625, 2) on a square grid about the origin, and their exact derivatives."""
    along = np.linspace(-GRID_EDGE, GRID_EDGE, GRID)
    x = np.stack(np.meshgrid(along, along), axis=-1).reshape(-1, 2)
    return x, task.derivative(0.0, x)


def rate_mse(model: Any, x: Array, dx: Array) -> float:
    """Mean squared error of the rates of `model` at states x (m, 2) against dx (m, 2)."""
    return float(np.mean((model.derivative(0.0, x) - dx) ** 2))


def energy_mse(task: Task, model: Model, seed: int, integrator: Integrator) -> float:
    """Mean over fifteen responses of the mean squared difference of q² + p² from the exact ones.

    The paper's measure. For the pendulum q² + p² is not its energy, and a phase error counts. A model that
    stands still keeps it too: see how far responses are off as well. Infinite if a response diverges.
    """
    generator = np.random.default_rng(seed)
    t = np.linspace(0.0, LONG_S, LONG_SAMPLES)
    errors = []
    for _ in range(STARTS):
        start = generator.uniform(-0.8, 0.8, size=2)
        start += 0.2 * np.sign(start)
        exact, found = simulate(task, t, start, TIGHT).x, simulate(model, t, start, integrator).x
        if len(found) < len(t):
            return float("inf")
        errors.append(np.mean((np.sum(exact**2, axis=1) - np.sum(found**2, axis=1)) ** 2))
    return float(np.mean(errors))
