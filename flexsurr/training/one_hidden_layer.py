"""Normal equations of every network with one hidden layer, without its Jacobian.

Maps and the MLP are y = a V + c with a = σ(x W + b). Hamiltonian fields of one hidden layer have the same
form, for ∇ Σ c_k σ(w_k · x + b_k) reads the slopes σ′ by c_k w_k. So there are two kinds of readout: with
weights of its own, and tied to the hidden weights.

With x̃ = (x, 1) of a sample, hidden values a, slopes d and outputs y_o = Σ_k a_k V_ko + c_o,

    ∂y_o/∂W_jk = x̃_j d_k V_ko        ∂y_o/∂V_ko = a_k        (biases by the 1 appended to x and a)

so that, summed over samples and over outputs of weights w_o,

- the block of the hidden weights is T = Σ_s (x̃_j x̃_j')(d_k d_k') times (V w Vᵀ)_kk', element by element: one
  product of two thin matrices, the distinct pairs of inputs and the distinct pairs of neurons;
- the blocks of the outputs are w_o times one Gram matrix K of (a, 1), and zero between outputs;
- between them stands G = Σ_s (x̃_j d_k)(a, 1), times w_o V_ko.

The Jacobian of 12 outputs would have 12 times the rows, and its square 12 times the work. The outputs'
blocks are eliminated together, since they differ by a factor alone: what remains to be factored is
(T − G K⁻¹ Gᵀ) times (V w Vᵀ)_kk', of the size of the hidden weights.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import LinAlgError, blas, cho_factor, cho_solve, solve_triangular
from scipy.sparse import csr_array

from flexsurr.simulation.rhs import Array
from flexsurr.surrogates import DissipativeHNN, Network
from flexsurr.surrogates.activations import activation_function
from flexsurr.surrogates.hnn import ScalarNetworks
from flexsurr.surrogates.layers import layer_shapes, views
from flexsurr.training.levenberg_marquardt import (
    Equations,
    NormalEquations,
    Solver,
    ones_for_zeros,
    second_difference,
    settling,
)
from flexsurr.training.losses import output_weights

CHUNK = 1 << 21  # products of two neurons that exist at a time: 16 MB


class Weights(NamedTuple):
    """W (n, h), b (h,), V (h, k) and c (k,), or no c."""

    inner: Array
    biases: Array
    readout: Array
    constants: Array | None


class Readout(Protocol):
    """How a vector of parameters makes a network of one hidden layer."""

    value: Callable[[Array], Array]
    slope: Callable[[Array], Array]

    def weights(self, parameters: Array) -> Weights:
        """The weights that they make."""
        ...

    def derivative(self, parameters: Array) -> csr_array | None:
        """∂(all weights in one vector)/∂(parameters); None where they are the same."""
        ...


class FreeReadout:
    """`parameters` are W, b, V and c one after the other: a map, or an MLP."""

    def __init__(self, inputs: int, hidden: int, outputs: int, activation: str) -> None:
        sigma = activation_function(activation)
        self.value, self.slope = sigma.value, sigma.slope
        self._shapes = layer_shapes((inputs, hidden, outputs))

    def weights(self, parameters: Array) -> Weights:
        """Views of the parameters."""
        return Weights(*views(parameters, self._shapes))

    def derivative(self, parameters: Array) -> None:
        """Nothing: they are the weights."""
        return


class TiedReadout:
    """The field of gradients of scalars Σ c_k σ(w_k · x + b_k): V_ko = ± c_k W_jk, without constants.

    Of the Hamiltonian, Hamilton's equations; of the dissipation function beside it, the gradient itself.
    `parameters` are those of `ScalarNetworks`: W, b and c of each.
    """

    def __init__(self, network: ScalarNetworks) -> None:
        self.value, self.slope = network.sigma.slope, network.sigma.curvature
        states, (hidden,) = len(network.state_names), network.hidden
        r, scalars = states // 2, network.networks
        # V (neuron, output) = c (neuron) sign (output) W (source of the output, neuron)
        turned = np.roll(np.arange(states), -r), np.repeat([1.0, -1.0], r)
        plain = np.arange(states), np.ones(states)
        sources = [turned, plain] if isinstance(network, DissipativeHNN) else [turned]
        neurons = np.arange(scalars * hidden)
        of, number = neurons // hidden, neurons % hidden
        source, self._signs = (np.array(part)[of] for part in zip(*sources, strict=True))
        size = (states + 2) * hidden
        inner = (of * size + number) + hidden * np.arange(states)[:, None]
        biases = of * size + states * hidden + number
        readout = biases + hidden
        # places among the parameters of W, of b, of what V is made of, and of c
        self._places = inner, biases, inner[source.T, neurons].T, readout
        self._count = scalars * size

    def weights(self, parameters: Array) -> Weights:
        """The weights, neurons of all scalars side by side."""
        inner, biases, source, readout = (parameters[places] for places in self._places)
        return Weights(inner, biases, readout[:, None] * self._signs * source, None)

    def derivative(self, parameters: Array) -> csr_array:
        """One for hidden weights and biases; of V by both its factors."""
        inner, biases, source, readout = self._places
        of_c = np.broadcast_to(readout[:, None], source.shape)
        columns = np.concatenate([inner.ravel(), biases, source.ravel(), of_c.ravel()])
        first = inner.size + biases.size
        rows = np.concatenate([np.arange(first + source.size), first + np.arange(source.size)])
        by_source, by_c = self._signs * parameters[of_c], self._signs * parameters[source]
        values = np.concatenate([np.ones(first), by_source.ravel(), by_c.ravel()])
        return csr_array((values, (rows, columns)), shape=(first + source.size, self._count))


@dataclass(frozen=True, eq=False)
class OneHiddenLayer:
    """The nmse of a network of one hidden layer at scaled inputs `x` (m, n) and outputs `y` (m, k).

    `output_weights` (k,) are those of the outputs' mean squared errors. Satisfies `Smooth`.
    """

    x: Array
    y: Array
    readout: Readout
    output_weights: Array

    @classmethod
    def of_map(
        cls, x: Array, y: Array, hidden: int, activation: str, weights: Array | None = None
    ) -> "OneHiddenLayer":
        """The objective for scaled samples; `weights` by the variance of `y` unless given."""
        readout = FreeReadout(x.shape[1], hidden, y.shape[1], activation)
        return cls(x, y, readout, output_weights(y) if weights is None else weights)

    @classmethod
    def of_field(cls, network: Network, x: Array, y: Array, weights: Array) -> "OneHiddenLayer":
        """That of a field at scaled states `x` and rates `y` (m, 2r); `weights` (2r,) are the outputs'."""
        if isinstance(network, ScalarNetworks):
            return cls(x, y, TiedReadout(network), weights)
        return cls.of_map(x, y, network.hidden[0], network.activation, weights)

    def outputs(self, parameters: Array) -> Array:
        """Scaled outputs (m, k) at the samples."""
        inner, biases, readout, constants = self.readout.weights(parameters)
        y = self.readout.value(self.x @ inner + biases) @ readout
        return y if constants is None else y + constants

    def loss(self, parameters: Array) -> float:
        """The nmse over all samples; not finite where a weight or an output is not."""
        return float(np.mean((self.outputs(parameters) - self.y) ** 2, axis=0) @ self.output_weights)

    def settled(self, parameters: Array) -> Array:
        """The same with V and c, weights of their own, at their least squares: each output by itself."""
        inner, biases, readout, constants = self.readout.weights(parameters)
        values = self.readout.value(self.x @ inner + biases)
        if constants is not None:
            values, readout = np.hstack([values, np.ones((len(values), 1))]), np.vstack([readout, constants])
        moved = settling(values.T @ values, values.T @ (values @ readout - self.y)).ravel()
        return np.concatenate([parameters[: -moved.size], parameters[-moved.size :] + moved])

    def gradient(self, parameters: Array, gradient: Array) -> float:
        """The loss, its gradient written into `gradient` (parameters,)."""
        weights = self.readout.weights(parameters)
        sums = _Sums.zero(weights, with_pairs=False)
        sums.add(self, weights, self.x, self.y)
        found, by_parameters = 2.0 * sums.gradient, self.readout.derivative(parameters)
        gradient[:] = found if by_parameters is None else by_parameters.T @ found
        return sums.loss

    def bend(self, parameters: Array, step: Array) -> Array:
        """Jᵀr″ (n,), of the second derivative r″ of the residuals along `step` (n,)."""
        here = self.outputs(parameters)
        second = second_difference(here, self.outputs, parameters, step)
        gradient = np.empty_like(parameters)
        replace(self, y=here - second).gradient(parameters, gradient)  # its residuals are r″
        return 0.5 * gradient

    def normal_equations(self, parameters: Array) -> Equations:
        """JᵀJ and Jᵀr; memory is that of JᵀJ and of `CHUNK`, however many samples there are."""
        weights = self.readout.weights(parameters)
        sums = _Sums.zero(weights, with_pairs=True)
        step = max(CHUNK // len(sums.pairs.T), 1)
        for first in range(0, len(self.x), step):
            part = slice(first, first + step)
            sums.add(self, weights, self.x[part], self.y[part])
        equations = BorderedEquations(
            sums.loss,
            sums.gradient,
            sums.pairs,
            sums.between,
            sums.outer,
            weights.readout,
            self.output_weights / len(self.x),
        )
        by_parameters = self.readout.derivative(parameters)
        if by_parameters is None:
            return equations
        gram = by_parameters.T @ (by_parameters.T @ equations.gram).T
        return NormalEquations(sums.loss, gram, by_parameters.T @ sums.gradient)


@dataclass(eq=False)
class _Sums:
    """What is summed over samples: the loss, Jᵀr, and T by pairs, G and K of this file's first lines."""

    loss: float
    gradient: Array
    pairs: Array
    between: Array
    outer: Array
    with_pairs: bool

    @classmethod
    def zero(cls, weights: Weights, with_pairs: bool) -> "_Sums":
        n, h = weights.inner.shape
        k, values = weights.readout.shape[1], h + (weights.constants is not None)
        shapes: list[tuple[int, ...]] = [((n + 1) * h + values * k,)]
        shapes += [((n + 1) * (n + 2) // 2, h * (h + 1) // 2), ((n + 1) * h, values), (values, values)]
        gradient, pairs, between, outer = (
            np.zeros(shape if with_pairs or len(shape) == 1 else 0) for shape in shapes
        )
        return cls(0.0, gradient, pairs, between, outer, with_pairs)

    def add(self, objective: OneHiddenLayer, weights: Weights, x: Array, y: Array) -> None:
        """Of samples x (m, n) and y (m, k)."""
        inner, biases, readout, constants = weights
        z = x @ inner + biases
        values, slopes = objective.readout.value(z), objective.readout.slope(z)
        ones = np.ones((len(x), 1))
        x = np.hstack([x, ones])
        if constants is not None:
            values, readout = np.hstack([values, ones]), np.vstack([readout, constants])
        errors = values @ readout - y
        pulled = (objective.output_weights / len(objective.x)) * errors
        back = (pulled @ readout[: slopes.shape[1]].T) * slopes
        self.loss += float(np.sum(pulled * errors))
        self.gradient += np.concatenate([(x.T @ back).ravel(), (values.T @ pulled).ravel()])
        if not self.with_pairs:
            return
        first, second = np.triu_indices(x.shape[1])
        # added where it stands, for a sum of two such matrices takes as long as small products
        blas.dgemm(
            1.0,
            _products_of_pairs(slopes).T,
            x[:, first] * x[:, second],
            beta=1.0,
            c=self.pairs.T,
            trans_a=True,
            overwrite_c=True,
        )
        products = (x[:, :, None] * slopes[:, None, :]).reshape(len(x), -1)
        self.between += products.T @ values
        self.outer += values.T @ values


@dataclass(frozen=True, eq=False)
class BorderedEquations:
    """JᵀJ of readouts with weights of their own, in its parts. Satisfies `Equations`.

    `pairs` (pairs of n + 1 inputs, pairs of h neurons), `between` ((n + 1) h, a) and `outer` (a, a) are T, G
    and K; a is h, and one more with constants. `readout` (h, k) is V, `output_weights` (k,) holds w_o.
    """

    loss: float
    gradient: Array
    pairs: Array
    between: Array
    outer: Array
    readout: Array
    output_weights: Array

    @cached_property
    def _mixed(self) -> Array:
        """V w Vᵀ (h, h)."""
        mixed: Array = (self.readout * self.output_weights) @ self.readout.T
        return mixed

    @cached_property
    def diagonal(self) -> Array:
        """Of JᵀJ."""
        h = len(self.readout)
        of_inputs, of_neurons = (_pair_numbers(count).diagonal() for count in (len(self.between) // h, h))
        inner = self.pairs[np.ix_(of_inputs, of_neurons)] * self._mixed.diagonal()
        outer = self.outer.diagonal()[:, None] * self.output_weights
        return np.concatenate([inner.ravel(), outer.ravel()])

    @property
    def gram(self) -> Array:
        """JᵀJ itself, which `step` does without."""
        inner, outer = len(self.between), self.outer.shape[0] * self.output_weights.size
        h, k = self.readout.shape
        gram = np.zeros((inner + outer, inner + outer))
        lower = np.tril(self._inner_less(np.zeros((inner, inner))))
        gram[:inner, :inner] = lower + np.tril(lower, -1).T
        scaled = self.readout * self.output_weights
        border = self.between.reshape(-1, h, len(self.outer), 1) * scaled[None, :, None, :]
        gram[:inner, inner:] = border.reshape(inner, outer)
        gram[inner:, :inner] = gram[:inner, inner:].T
        blocks = np.einsum("ab,o,op->aobp", self.outer, self.output_weights, np.eye(k))
        gram[inner:, inner:] = blocks.reshape(outer, outer)
        return gram

    def solver(self, damping: Array) -> Solver | None:
        """The solution with JᵀJ + diag(damping), or None where rounding leaves it not positive definite.

        As the diagonal of JᵀJ does, the damping of the outputs' weights goes with w_o.
        """
        inner, h = len(self.between), len(self.readout)
        of_inner = ones_for_zeros(damping[:inner])
        of_outer = ones_for_zeros(damping[inner:].reshape(len(self.outer), -1)[:, 0] / self.output_weights[0])
        try:
            outer = cho_factor(self.outer + np.diag(of_outer), check_finite=False)
            halves = solve_triangular(outer[0], self.between.T, trans=1, check_finite=False)
            reduced = self._inner_less(blas.dsyrk(1.0, halves, trans=True).T)
            reduced.flat[:: inner + 1] += of_inner
            # the lower triangle, row by row, is what LAPACK takes for an upper one: nothing is copied
            factor = cho_factor(reduced.T, overwrite_a=True, check_finite=False)
        except LinAlgError:
            return None

        def solve(right: Array) -> Array:
            by_output = right[inner:].reshape(len(self.outer), -1)
            eliminated = (self.between @ cho_solve(outer, by_output)).reshape(-1, h, self.readout.shape[1])
            reduced_right = np.einsum("jko,ko->jk", eliminated, self.readout).ravel() - right[:inner]
            solution = cho_solve(factor, reduced_right, check_finite=False)
            moved = solution.reshape(-1, h, 1) * self.readout
            coupled = self.between.T @ moved.reshape(inner, -1)
            of_outputs = cho_solve(outer, -by_output / self.output_weights - coupled)
            return np.concatenate([solution, of_outputs.ravel()])

        return solve

    def _inner_less(self, matrix: Array) -> Array:
        """(T − matrix) times (V w Vᵀ), element by element, in place of `matrix`; its lower triangle alone."""
        h = len(self.readout)
        inputs = len(self.between) // h
        of_inputs, of_neurons = _pair_numbers(inputs), _pair_numbers(h)
        blocks = matrix.reshape(inputs, h, inputs, h)
        for j in range(inputs):
            pairs = self.pairs[of_inputs[j, : j + 1]][:, of_neurons].transpose(1, 0, 2)
            row = blocks[j, :, : j + 1]
            np.subtract(pairs, row, out=row)
            row *= self._mixed[:, None, :]
        return matrix


def _products_of_pairs(slopes: Array) -> Array:
    """The distinct products of two columns of `slopes` (m, hidden), as rows (hidden (hidden + 1) / 2, m)."""
    columns = np.ascontiguousarray(slopes.T)
    hidden = len(columns)
    products = np.empty((hidden * (hidden + 1) // 2, len(slopes)))
    place = 0
    for k in range(hidden):  # rows of neighbouring numbers, five times as fast as by index
        np.multiply(columns[k], columns[k:], out=products[place : place + hidden - k])
        place += hidden - k
    return products


def _pair_numbers(count: int) -> NDArray[np.int64]:
    """Place of the pair (i, j), in either order, among the distinct ones: (count, count)."""
    numbers = np.empty((count, count), dtype=np.int64)
    upper = np.triu_indices(count)
    numbers[upper] = np.arange(len(upper[0]))
    numbers.T[upper] = numbers[upper]
    return numbers
