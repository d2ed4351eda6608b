"""Levenberg–Marquardt: damped Gauss–Newton steps on a sum of squares, in double precision.

The damping μ follows the gain ratio (H. B. Nielsen, *Damping parameter in Marquardt's method*,
IMM-REP-1999-05, eq. 2.11); it is scaled by the largest diagonal of JᵀJ met so far (Moré 1978), so that
the steps don't depend on the units of single weights. A step that does not lessen the loss is repeated
with more damping from the same JᵀJ, which is accumulated so that memory does not grow with the samples.
What JᵀJ is made of, and how its system is solved, is the objective's affair.

Where the objective knows how residuals bend along a step, the step bends too, by the same factors: the
geodesic acceleration of Transtrum & Sethna, *Improvements to the Levenberg-Marquardt algorithm for nonlinear
least-squares minimization*, arXiv:1201.5885. Networks then take a fraction of the steps.

Where residuals are linear in some of the parameters, as in the weights that read a layer, these are settled
by linear least squares after every step: variable projection (Golub & Pereyra, SIAM J. Numer. Anal. 10 (1973)
413), its steps those of all parameters together (Ruhe & Wedin, SIAM Review 22 (1980) 318). So it is with maps
and the entries of a mass matrix, but not with fields: from noisy rates it makes large weights that cancel
within the samples, and responses beyond them without bound.
"""

from collections.abc import Callable, Iterator
from typing import NamedTuple, Protocol, runtime_checkable

import numpy as np
from scipy.linalg import LinAlgError, cho_factor, cho_solve

from flexsurr.simulation.rhs import Array
from flexsurr.training.epochs import Optimiser

Rows = Callable[[slice, Array, Array], None]
"""Fills residuals and Jacobian of a slice of the samples; both may be longer than the slice asks for."""
Solver = Callable[[Array], Array]
"""Gives −(JᵀJ + damping)⁻¹ times a vector (n,)."""
INITIAL_DAMPING = 1e-2
LARGEST_DAMPING = 1e12
SMALLEST_DAMPING = 1e-15
LARGEST_BEND = 0.75  # twice the acceleration over the step: beyond, a parabola is no better than a line
BEND_OVER = 0.1  # of the step that residuals are differenced over
NEARLY_SINGULAR = 1e-12  # added to the diagonal of linear parameters' JᵀJ, relative to it


class Equations(Protocol):
    """The normal equations at some weights, of residuals r whose sum of squares is the loss."""

    @property
    def loss(self) -> float:
        """The sum of squares."""
        ...

    @property
    def gradient(self) -> Array:
        """Jᵀr (n,)."""
        ...

    @property
    def diagonal(self) -> Array:
        """Of JᵀJ (n,)."""
        ...

    def solver(self, damping: Array) -> Solver | None:
        """The solution with JᵀJ + diag(damping), or None where rounding leaves it not positive definite.

        `damping` (n,) is a multiple of the largest diagonals met so far.
        """
        ...


class NormalEquations(NamedTuple):
    """JᵀJ (n, n) as one matrix, and Jᵀr (n,). Satisfies `Equations`."""

    loss: float
    gram: Array
    gradient: Array

    @property
    def diagonal(self) -> Array:
        """Of JᵀJ (n,)."""
        return self.gram.diagonal()

    def solver(self, damping: Array) -> Solver | None:
        """By Cholesky's factors of the whole matrix."""
        damped = self.gram.copy()
        damped.flat[:: len(damped) + 1] += ones_for_zeros(damping)
        try:
            # its transpose is in LAPACK's own order, so that it is factored in its place
            factor = cho_factor(damped.T, overwrite_a=True, check_finite=False)
        except LinAlgError:
            return None
        return lambda right: -cho_solve(factor, right, check_finite=False)


def ones_for_zeros(damping: Array) -> Array:
    """The same with ones for zeros: a weight that nothing depends on stays where it is."""
    return np.where(damping > 0.0, damping, 1.0)


def settling(gram: Array, gradient: Array) -> Array:
    """What linear parameters move by: −(their JᵀJ)⁻¹ Jᵀr, (n,) or a column for each output (n, k).

    Nearly the shortest one where they are not determined; zeros where rounding leaves no solution.
    """
    damped = gram.copy()
    damped.flat[:: len(gram) + 1] += ones_for_zeros(NEARLY_SINGULAR * gram.diagonal())
    try:
        factor = cho_factor(damped, check_finite=False)
    except LinAlgError:
        return np.zeros_like(gradient)
    moved: Array = -cho_solve(factor, gradient, check_finite=False)
    return moved


def accumulated(rows: Rows, shape: tuple[int, ...], unknowns: int, chunk: int) -> NormalEquations:
    """Of `shape` = (m, d) residuals, d for each sample; at most `chunk` elements of the Jacobian at a time.

    Of the Jacobian there is at least one sample's part.
    """
    loss, gram, gradient = 0.0, np.zeros((unknowns, unknowns)), np.zeros(unknowns)
    for _, residuals, jacobian in _pieces(rows, shape, unknowns, chunk):
        loss += float(residuals @ residuals)
        gram += jacobian.T @ jacobian
        gradient += jacobian.T @ residuals
    return NormalEquations(loss, gram, gradient)


def pulled(rows: Rows, shape: tuple[int, ...], unknowns: int, chunk: int, vector: Array) -> Array:
    """Jᵀ times a `vector` (m · d,), in the same pieces."""
    product = np.zeros(unknowns)
    for place, _, jacobian in _pieces(rows, shape, unknowns, chunk):
        product += jacobian.T @ vector[place]
    return product


def _pieces(
    rows: Rows, shape: tuple[int, ...], unknowns: int, chunk: int
) -> Iterator[tuple[slice, Array, Array]]:
    """Residuals and Jacobian piece by piece, each with its place among all residuals."""
    samples, d = shape
    step = min(max(chunk // (unknowns * d), 1), samples)
    jacobian, residuals = np.empty((step * d, unknowns)), np.empty(step * d)
    for first in range(0, samples, step):
        last = min(first + step, samples)
        rows(slice(first, last), residuals, jacobian)
        filled = d * (last - first)
        yield slice(d * first, d * last), residuals[:filled], jacobian[:filled]


def second_difference(
    here: Array, outputs: Callable[[Array], Array], parameters: Array, step: Array
) -> Array:
    """The second derivative of `outputs` along `step` (n,) at `parameters` (n,), where they are `here`."""
    ahead, behind = (outputs(parameters + sign * BEND_OVER * step) for sign in (1.0, -1.0))
    second: Array = (ahead - 2.0 * here + behind) / BEND_OVER**2
    return second


class SumOfSquares(Protocol):
    """What Levenberg–Marquardt minimises."""

    def loss(self, parameters: Array) -> float:
        """The sum of squares."""
        ...

    def normal_equations(self, parameters: Array) -> Equations:
        """JᵀJ, Jᵀr and the sum of squares."""
        ...


@runtime_checkable
class Bending(Protocol):
    """A sum of squares that knows the second derivatives of its residuals."""

    def bend(self, parameters: Array, step: Array) -> Array:
        """Jᵀr″ (n,), of the second derivative r″ of the residuals along `step` (n,)."""
        ...


@runtime_checkable
class Separable(Protocol):
    """A sum of squares of residuals that are linear in some of the parameters."""

    def settled(self, parameters: Array) -> Array:
        """The same with the linear ones at their least squares, given the others (n,)."""
        ...


class Smooth(SumOfSquares, Protocol):
    """A sum of squares with a gradient of its own, cheaper than JᵀJ."""

    def gradient(self, parameters: Array, gradient: Array) -> float:
        """The sum of squares, its gradient written into `gradient`."""
        ...


def second_order(name: str, objective: Smooth, parameters: Array) -> Optimiser:
    """The optimiser `name` from weights `parameters`: lbfgs or levenberg_marquardt."""
    if name == "lbfgs":
        from flexsurr.training.lbfgs import LBFGS  # here, for it imports torch

        return LBFGS(objective, parameters)
    return LevenbergMarquardt(objective, parameters)


class LevenbergMarquardt:
    """One call of `epoch` is one accepted step. Satisfies `Optimiser`."""

    def __init__(self, objective: SumOfSquares, parameters: Array) -> None:
        self.finished = ""
        self._objective = objective
        self.parameters = parameters.copy()
        self._damping = INITIAL_DAMPING
        self._growth = 2.0
        self._equations = objective.normal_equations(self.parameters)
        self._largest = self._equations.diagonal

    def epoch(self) -> float:
        """Take one step that lessens the loss; the loss after it. `finished` says when there is none."""
        loss, gradient = self._equations.loss, self._equations.gradient
        while self._damping < LARGEST_DAMPING:
            damping = self._damping * self._largest
            solve = self._equations.solver(damping)
            if solve is not None:
                step = solve(gradient)
                predicted = float(step @ (damping * step - gradient))
                step = step + self._acceleration(solve, step)
                reached = self._settled(self.parameters + step)
                gained = loss - self._objective.loss(reached)
                if gained > 0.0 and predicted > 0.0:
                    gain = min(gained / predicted, 1.0)
                    self.parameters = reached
                    self._damping *= max(1.0 / 3.0, 1.0 - (2.0 * gain - 1.0) ** 3)
                    self._damping = max(self._damping, SMALLEST_DAMPING)
                    self._growth = 2.0
                    self._equations = self._objective.normal_equations(self.parameters)
                    self._largest = np.maximum(self._largest, self._equations.diagonal)
                    return self._equations.loss
            self._damping *= self._growth
            self._growth *= 2.0
        self.finished = "no step lessens the loss"
        return loss

    def _settled(self, parameters: Array) -> Array:
        return self._objective.settled(parameters) if isinstance(self._objective, Separable) else parameters

    def _acceleration(self, solve: Solver, step: Array) -> Array | float:
        """What is added to `step`; nothing where it is unknown, or too large to be trusted."""
        if not isinstance(self._objective, Bending):
            return 0.0
        acceleration = 0.5 * solve(self._objective.bend(self.parameters, step))
        roots = np.sqrt(self._largest)
        sizes = np.linalg.norm(roots * acceleration), np.linalg.norm(roots * step)
        return acceleration if 2.0 * sizes[0] <= LARGEST_BEND * sizes[1] else 0.0

    def state(self) -> dict[str, Array]:
        """Everything that the next epoch depends on."""
        return {
            "parameters": self.parameters,
            "damping": np.array([self._damping, self._growth]),
            "largest": self._largest,
        }

    def restore(self, state: dict[str, Array]) -> None:
        """Go on from a `state`."""
        self.parameters = state["parameters"].copy()
        self._damping, self._growth = state["damping"].tolist()
        self._largest = state["largest"].copy()
        self._equations = self._objective.normal_equations(self.parameters)
