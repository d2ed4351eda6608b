"""JᵀJ of a network with one hidden layer and several outputs, without its Jacobian.

With x̃ = (x, 1) of a sample, hidden values a, slopes d and outputs y_o = Σ_k a_k V_ko + c_o,

    ∂y_o/∂W_jk = x̃_j d_k V_ko        ∂y_o/∂V_ko = a_k        (biases by the 1 appended to x and a)

so that, summed over samples and over outputs of weights w_o,

- the block of the hidden weights is Σ_s (x̃_j x̃_j')(d_k d_k') times (V w Vᵀ)_kk', element by element: one
  product of two thin matrices, the distinct pairs of inputs and the distinct pairs of neurons;
- the blocks of the outputs are w_o times one Gram matrix of (a, 1), and zero between outputs;
- between them stands the product of both, times w_o V_ko.

The Jacobian of 12 outputs would have 12 times the rows, and its square 12 times the work.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from flexsurr.simulation.rhs import Array
from flexsurr.surrogates.activations import ACTIVATIONS
from flexsurr.surrogates.layers import layer_shapes, views
from flexsurr.training.levenberg_marquardt import NormalEquations
from flexsurr.training.losses import output_weights


@dataclass(frozen=True, eq=False)
class MapObjective:
    """The nmse of a network of one hidden layer at scaled inputs `x` (m, n) and outputs `y` (m, k).

    `weights` (k,) are those of the outputs' mean squared errors. Satisfies `SumOfSquares`.
    """

    x: Array
    y: Array
    hidden: int
    activation: str
    weights: Array

    @classmethod
    def of(
        cls, x: Array, y: Array, hidden: int, activation: str, weights: Array | None = None
    ) -> "MapObjective":
        """The objective for scaled samples; `weights` by the variance of `y` unless given."""
        return cls(x, y, hidden, activation, output_weights(y) if weights is None else weights)

    @cached_property
    def _inputs(self) -> Array:
        """x̃ (m, n + 1)."""
        return np.hstack([self.x, np.ones((len(self.x), 1))])

    @cached_property
    def _input_pairs(self) -> Array:
        """The distinct products of two of x̃, (m, (n + 1)(n + 2) / 2)."""
        first, second = np.triu_indices(self._inputs.shape[1])
        return self._inputs[:, first] * self._inputs[:, second]

    def loss(self, parameters: Array) -> float:
        """The nmse over all samples; not finite where a weight or an output is not."""
        return float(np.mean(self.residuals(parameters) ** 2, axis=0) @ self.weights)

    def residuals(self, parameters: Array) -> Array:
        """Errors (m, k) of the scaled outputs."""
        weights, biases, weights_out, biases_out = self.unpacked(parameters)
        value = ACTIVATIONS[self.activation].value
        return value(self.x @ weights + biases) @ weights_out + biases_out - self.y

    def unpacked(self, parameters: Array) -> list[Array]:
        """Views of the parameters: hidden weights and biases, then the output's."""
        return views(parameters, layer_shapes((self.x.shape[1], self.hidden, self.y.shape[1])))

    def gradient(self, parameters: Array, gradient: Array) -> float:
        """The loss, its gradient written into `gradient` (parameters,)."""
        weights, biases, weights_out, biases_out = self.unpacked(parameters)
        sigma = ACTIVATIONS[self.activation]
        z = self.x @ weights + biases
        a = sigma.value(z)
        errors = a @ weights_out + biases_out - self.y
        pulled = (2.0 * self.weights / len(self.x)) * errors
        back = (pulled @ weights_out.T) * sigma.slope(z)
        parts = (self.x.T @ back, back.sum(axis=0), a.T @ pulled, pulled.sum(axis=0))
        np.concatenate([part.ravel() for part in parts], out=gradient)
        return float(np.mean(errors**2, axis=0) @ self.weights)

    def normal_equations(self, parameters: Array) -> NormalEquations:
        """JᵀJ and Jᵀr; memory is that of the samples' products of pairs and twice that of JᵀJ."""
        weights, biases, weights_out, _ = self.unpacked(parameters)
        sigma = ACTIVATIONS[self.activation]
        m, k = self.y.shape
        z = self.x @ weights + biases
        slopes = sigma.slope(z)
        a = np.hstack([sigma.value(z), np.ones((m, 1))])
        inputs = self._inputs
        mean_weights = self.weights / m
        inner = inputs.shape[1] * self.hidden
        gram = np.empty((parameters.size, parameters.size))
        first, second = np.triu_indices(self.hidden)
        mixed = (weights_out * mean_weights) @ weights_out.T
        pairs = (_products_of_pairs(slopes) @ self._input_pairs).T * mixed[first, second]
        # (inputs, hidden, inputs, hidden), in the order of the parameters
        of_inputs, of_neurons = _pair_numbers(inputs.shape[1]), _pair_numbers(self.hidden)
        block = pairs[of_inputs[:, None, :, None], of_neurons[None, :, None, :]]
        gram[:inner, :inner] = block.reshape(inner, inner)
        products = (inputs[:, :, None] * slopes[:, None, :]).reshape(m, inner)
        # (inputs, hidden, a, k)
        between = (products.T @ a).reshape(inputs.shape[1], self.hidden, -1, 1)
        between = between * (weights_out * mean_weights)[None, :, None, :]
        gram[:inner, inner:] = between.reshape(inner, -1)
        gram[inner:, :inner] = gram[:inner, inner:].T
        outer = np.einsum("ab,o,op->aobp", a.T @ a, mean_weights, np.eye(k))
        gram[inner:, inner:] = outer.reshape(a.shape[1] * k, -1)
        gradient = np.empty_like(parameters)
        loss = self.gradient(parameters, gradient)
        return NormalEquations(loss, gram, 0.5 * gradient)


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
