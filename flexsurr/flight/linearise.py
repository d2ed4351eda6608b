"""Small motions about a trim: the matrix A of ẋ = A x, its eigenvalues, and which mode each belongs to."""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import linear_sum_assignment

from flexsurr.flight.equations_of_motion import RIGID_BODY
from flexsurr.flight.model import FlightModel
from flexsurr.flight.trim import Trim
from flexsurr.simulation.rhs import Array, evaluate

# Position and heading change nothing about small motions but for the air's density.
LEFT_OUT = ("north_m", "east_m", "altitude_m", "psi")
RIGID_MODES: dict[str, tuple[str, ...]] = {
    "short period": ("w", "q"),
    "phugoid": ("u", "theta"),
    "dutch roll": ("v", "r"),
    "roll": ("p",),
    "spiral": ("phi",),
}
_REAL = 1e-9


@dataclass(frozen=True, eq=False)
class NaturalMode:
    """An eigenvalue [1/s] (of a pair the one with positive imaginary part) and its eigenvector.

    `participation` (d,) tells what share of the mode each state has: |left| · |right| eigenvector, their
    sum is one, independent of units.
    """

    name: str
    eigenvalue: complex
    vector: Array
    participation: Array


def state_matrix(model: FlightModel, state: Array) -> tuple[Array, tuple[str, ...]]:
    """A (d, d) at `state` by central differences without the states `LEFT_OUT`, and the states' names."""
    kernel, work = model.kernel, np.empty(model.work_size)
    names = model.state_names
    kept = [i for i, name in enumerate(names) if name not in LEFT_OUT]
    steps = np.full(len(names), 1e-3)  # η in kg^½ m
    rigid = {"u": 1e-2, "v": 1e-2, "w": 1e-2}
    steps[: len(RIGID_BODY)] = [rigid.get(name, 1e-5) for name in RIGID_BODY]
    matrix = np.empty((len(kept), len(kept)))
    ahead, behind = np.empty(len(names)), np.empty(len(names))
    for column, i in enumerate(kept):
        x = state.copy()
        x[i] = state[i] + steps[i]
        evaluate(kernel, 0.0, x, ahead, work)
        x[i] = state[i] - steps[i]
        evaluate(kernel, 0.0, x, behind, work)
        matrix[:, column] = ((ahead - behind) / (2.0 * steps[i]))[kept]
    return matrix, tuple(names[i] for i in kept)


def linearise(trim: Trim) -> list[NaturalMode]:
    """The modes of small motions about `trim`: rigid-body ones first, then elastic ones by number."""
    return natural_modes(*state_matrix(trim.model, trim.state))


def natural_modes(matrix: Array, names: tuple[str, ...]) -> list[NaturalMode]:
    """Eigenvalues of `matrix` (d, d), each named after the states that take part in it.

    Every name goes to one mode, so that participation in total is largest; a mode that is left over (a pair
    that has fallen apart into two real eigenvalues) is called "real" with its number.
    """
    values, right = np.linalg.eig(matrix)
    left = np.linalg.inv(right)
    shares = np.abs(right * left.T)
    shares /= shares.sum(axis=0)
    upper = [i for i, value in enumerate(values) if value.imag >= -_REAL * max(abs(value), 1.0)]
    elastic = sum(name.startswith("eta_dot_") for name in names)
    groups = {**RIGID_MODES}
    for k in range(1, elastic + 1):
        groups[f"elastic {k}"] = (f"eta_{k}", f"eta_dot_{k}")
    scores = np.array(
        [
            [sum(shares[names.index(state), i] for state in states) for states in groups.values()]
            for i in upper
        ]
    )
    rows, columns = linear_sum_assignment(scores, maximize=True)
    labels = {upper[row]: list(groups)[column] for row, column in zip(rows, columns, strict=True)}
    unnamed = iter(range(1, len(upper) + 1))
    modes = [
        NaturalMode(
            labels[i] if i in labels else f"real {next(unnamed)}",
            complex(values[i]),
            right[:, i],
            shares[:, i],
        )
        for i in upper
    ]
    order = [*groups]
    return sorted(modes, key=lambda mode: order.index(mode.name) if mode.name in order else len(order))
