"""An even Hamiltonian network before training, and its loss with the Jacobian in closed form."""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from flexsurr.simulation.rhs import Array
from flexsurr.surrogates import EvenHNN, canonical_scaling
from flexsurr.surrogates.even_hnn import derivatives_of_products, products
from flexsurr.training.dataset import Dataset
from flexsurr.training.levenberg_marquardt import NormalEquations, accumulated, second_difference
from flexsurr.training.losses import output_weights

CHUNK = 1 << 20  # elements of the Jacobian that exist at a time: 8 MB
SPREAD = 2.0  # of weights and biases: scaled products reach one


def untrained_even_hnn(dataset: Dataset, hidden: tuple[int, ...], activation: str, seed: int) -> EvenHNN:
    """Random neurons whose bends lie all over the products."""
    generator = np.random.default_rng(seed)
    (inputs, neurons), *_ = EvenHNN.shapes(len(dataset.state_names), hidden[0])
    parameters = [
        SPREAD * generator.standard_normal((inputs, neurons)),
        SPREAD * generator.uniform(-1.0, 1.0, neurons),
        generator.uniform(-1.0, 1.0, neurons) / np.sqrt(neurons),
    ]
    return EvenHNN(
        np.concatenate([part.ravel() for part in parameters]),
        canonical_scaling(dataset.scales),
        dataset.state_names,
        dataset.state_units,
        hidden=hidden,
        activation=activation,
    )


@dataclass(frozen=True, eq=False)
class EvenHNNObjective:
    """The nmse of `network`, with any weights, over samples of scaled `x` and `y` (m, 2r).

    `roots` (2r,) are the roots of the weights of the squared errors, by m. Satisfies `Smooth`.
    """

    network: EvenHNN
    x: Array
    y: Array
    roots: Array

    @classmethod
    def of(cls, network: EvenHNN, x: Array, dx: Array) -> "EvenHNNObjective":
        """The objective for states `x` and derivatives `dx` (m, 2r), both in their units."""
        count = x.shape[1]
        y = dx / network.scaling.rates(count)
        return cls(network, x / network.scaling.states(count), y, np.sqrt(output_weights(y) / len(x)))

    @cached_property
    def _inputs(self) -> tuple[Array, Array]:
        """Products (m, i), and their derivatives (m, output, i) as Hamilton's equations take them."""
        by_x = derivatives_of_products(self.x)
        by_q, by_p = np.split(by_x, 2, axis=1)
        return products(self.x), np.concatenate([by_p, -by_q], axis=1)

    def loss(self, parameters: Array) -> float:
        """The nmse over all samples; not finite where a weight or the field is not."""
        return float(np.sum((self.roots * (self._field(parameters) - self.y)) ** 2))

    def _field(self, parameters: Array) -> Array:
        """The scaled field (m, 2r) at all samples."""
        return replace(self.network, parameters=parameters).scaled_field(self.x)

    def gradient(self, parameters: Array, gradient: Array) -> float:
        """The loss, its gradient written into `gradient` (parameters,)."""
        errors = self._field(parameters) - self.y
        gradient[:] = 2.0 * self._pulled(parameters, errors)
        return float(np.sum((self.roots * errors) ** 2))

    def bend(self, parameters: Array, step: Array) -> Array:
        """Jᵀr″ (n,), of the second derivative r″ of the residuals along `step` (n,)."""
        second = second_difference(self._field(parameters), self._field, parameters, step)
        return self._pulled(parameters, second)

    def _pulled(self, parameters: Array, errors: Array) -> Array:
        """Jᵀr (n,) of `errors` (m, 2r) of the field."""
        network = replace(self.network, parameters=parameters)
        weights, biases, readout = network.arrays()
        s, by_s = self._inputs
        z = s @ weights + biases
        # Σ_o errors_o f_o = Σ_k c_k σ′_k (turned W)_k
        turned = np.einsum("so,soi->si", self.roots**2 * errors, by_s)
        along = turned @ weights
        slopes, by_biases = network.sigma.slope(z), readout * network.sigma.curvature(z) * along
        by_weights = s.T @ by_biases + turned.T @ (readout * slopes)
        return np.concatenate([by_weights.ravel(), by_biases.sum(axis=0), np.sum(slopes * along, axis=0)])

    def normal_equations(self, parameters: Array) -> NormalEquations:
        """JᵀJ and Jᵀr, accumulated over pieces of the Jacobian."""
        network = replace(self.network, parameters=parameters)
        weights, biases, readout = network.arrays()

        def rows(part: slice, residuals: Array, jacobian: Array) -> None:
            s, by_s = (each[part] for each in self._inputs)
            z = s @ weights + biases
            # f_o = Σ_k c_k σ′_k turned_ok, turned = ∂s/∂x W: by W through both of its places
            slopes, curvatures = network.sigma.slope(z), readout * network.sigma.curvature(z)
            turned = by_s @ weights
            by_biases = curvatures[:, None, :] * turned
            by_readout = slopes[:, None, :] * turned
            by_weights = s[:, None, :, None] * by_biases[:, :, None, :]
            by_weights += by_s[..., None] * (readout * slopes)[:, None, None, :]
            filled = self.y[part].size
            errors = by_readout @ readout - self.y[part]
            residuals[:filled] = (self.roots * errors).ravel()
            columns = [by_weights.reshape(*errors.shape, -1), by_biases, by_readout]
            jacobian[:filled] = (self.roots[:, None] * np.concatenate(columns, axis=-1)).reshape(filled, -1)

        return accumulated(rows, self.x.shape, parameters.size, CHUNK)
