"""Port-Hamiltonian networks: before training, and what trains them.

Where the network gives the factor of M, two stages: inverse dynamics, then the error of the field. Where it
gives M's own entries, it is a map like any other, from configurations to a mass matrix: the reduced model's
where samples have it, otherwise the polynomial one that inverse dynamics finds.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial

import numpy as np

from flexsurr.simulation.rhs import Array
from flexsurr.storage import Scales
from flexsurr.surrogates import NetworkPortHamiltonian, PolynomialPortHamiltonian
from flexsurr.surrogates.layers import layer_shapes, views
from flexsurr.surrogates.mirrored_mass import Images
from flexsurr.surrogates.packed import pack, packed_size, semidefinite_factor, symmetric
from flexsurr.training.configuration_samples import ConfigurationSamples
from flexsurr.training.dataset import Dataset
from flexsurr.training.initialisation import initial_weights
from flexsurr.training.inverse_dynamics import NotPositiveDefinite, channel_spread, fit_port_hamiltonian
from flexsurr.training.levenberg_marquardt import (
    LevenbergMarquardt,
    NormalEquations,
    accumulated,
    pulled,
    second_difference,
)
from flexsurr.training.losses import nmse, output_weights, spreads
from flexsurr.training.mirrored_layer import MirroredLayer
from flexsurr.training.one_hidden_layer import OneHiddenLayer
from flexsurr.training.port_hamiltonian_rows import residuals_and_jacobian

CHUNK = 1 << 20  # elements of the Jacobian that exist at a time: 8 MB
INVERSE_EPOCHS = 60  # more of them no longer help the second stage
INVERSE_WEIGHT = 100.0  # of the first stage's loss in the second
BASE_DEGREE = 4
TARGET_DEGREES = (8, 6, 4, 2)  # of the polynomial whose mass matrix a network of entries learns
LARGEST_TARGET = 2000  # coefficients of its mass matrix
FLOOR = 0.01  # of the mean mass matrix
READOUT = 0.1  # of its diagonal, all neurons together
NEARLY_ZERO = 1e-9  # beside the largest eigenvalue of a mass matrix
SMALLEST = 1e-3  # eigenvalue of the mean mass matrix over the largest


@dataclass(frozen=True, eq=False)
class PortHamiltonianObjective:
    """A mean squared error of `network`, with any parameters, over samples of scaled `x` and `y` (m, 2r).

    forward: the nmse of the field. Otherwise: that of inverse dynamics, of p and of ṗ at the measured rates.
    `roots` (2r,) are the roots of the weights of the squared errors, by their number 2r and m.
    """

    network: NetworkPortHamiltonian
    x: Array
    y: Array
    roots: Array
    forward: bool

    @classmethod
    def of(
        cls, network: NetworkPortHamiltonian, x: Array, dx: Array, forward: bool
    ) -> "PortHamiltonianObjective":
        """The objective for states `x` and derivatives `dx` (m, 2r), both in their units."""
        count = x.shape[1]
        y = dx / network.scaling.rates(count)
        if forward:
            weights = output_weights(y)
        else:
            weights = 1.0 / (count * channel_spread(network.scaling, Scales.of(x, dx)) ** 2)
        x = x / network.scaling.states(count)
        if network.potential is not None:  # what is left to the springs
            y[:, network.pairs :] += network.potential.gradient(x[:, : network.pairs])
        return cls(network, x, y, np.sqrt(weights / len(x)), forward)

    @cached_property
    def _floor(self) -> Array:
        return symmetric(self.network.floor, self.network.pairs)

    def _rows(self, parameters: Array, part: slice, residuals: Array, jacobian: Array) -> None:
        x, y = self.x[part], self.y[part]
        residuals_and_jacobian(
            self.network.sigma.tag, self.network.even, self.network.hidden[0], parameters, self._floor,
            x, y, self.roots, self.forward, residuals[: x.size], jacobian[: x.size],
        )  # fmt: skip

    def loss(self, parameters: Array) -> float:
        """The weighted mean squared error over all samples."""
        residuals = self._residuals(parameters)
        return float(residuals @ residuals)

    def _residuals(self, parameters: Array) -> Array:
        residuals = np.empty(self.x.size)
        self._rows(parameters, slice(None), residuals, np.empty((0, parameters.size)))
        return residuals

    def normal_equations(self, parameters: Array) -> NormalEquations:
        """JᵀJ and Jᵀr, accumulated over pieces of the Jacobian."""
        return accumulated(partial(self._rows, parameters), self.x.shape, parameters.size, CHUNK)

    def bend(self, parameters: Array, step: Array) -> Array:
        """Jᵀr″ (n,), of the second derivative r″ of the residuals along `step` (n,)."""
        second = second_difference(self._residuals(parameters), self._residuals, parameters, step)
        return pulled(partial(self._rows, parameters), self.x.shape, parameters.size, CHUNK, second)


def untrained_port_hamiltonian(
    dataset: Dataset, hidden: tuple[int, ...], activation: str, seed: int, potential: bool = False
) -> NetworkPortHamiltonian:
    """Random neurons about the mean mass matrix, springs and dampers of a polynomial fit by least squares.

    Whether M is even in q is taken from that fit, and the `potential` too, which training leaves as it is.
    """
    return _about(_polynomial(dataset, (BASE_DEGREE,), potential), dataset, hidden, activation, seed)


def untrained_entries(
    dataset: Dataset, hidden: tuple[int, ...], activation: str, seed: int, potential: bool = False
) -> tuple[NetworkPortHamiltonian, Array]:
    """The same whose network gives M's entries, small random ones, and the M̂ to learn (m, r, r).

    Everything but the network stays as it is.
    """
    known = isinstance(dataset, ConfigurationSamples)
    polynomial = _polynomial(dataset, (BASE_DEGREE,) if known else TARGET_DEGREES, potential)
    network = _about(polynomial, dataset, hidden, activation, seed)
    _, of_q, of_p, of_rates = network.scales()
    if isinstance(dataset, ConfigurationSamples):
        mass = dataset.mass * of_rates / of_p[:, None]
    else:
        mass = polynomial.scaled_mass(dataset.x_train[:, : network.pairs] / of_q)
    weights, *_, springs, dampers = network.arrays()
    first = _first_layers(len(weights), hidden[0], seed, mass, known)
    parameters = _as_surrogate(first, springs, dampers)
    return replace(network, factored=False, parameters=parameters), mass


def _first_layers(inputs: int, hidden: int, seed: int, mass: Array, known: bool) -> list[Array]:
    """Weights, biases, readout and constants of a map to M̂; where that is `known` each entry by its size."""
    shape = inputs, hidden, packed_size(mass.shape[-1])
    weights, biases, readout, constants = views(
        initial_weights(*shape, seed, spread=1.0), layer_shapes(shape)
    )
    if known:
        sizes = 1.0 / np.sqrt(_mean_inverse(mass))
        readout = readout * pack(np.outer(sizes, sizes))
    return [weights, biases, readout, constants]


def untrained_mirrored(
    samples: ConfigurationSamples,
    hidden: tuple[int, ...],
    activation: str,
    seed: int,
    potential: bool = False,
) -> tuple[NetworkPortHamiltonian, Array]:
    """The same with `hidden` neurons that come with their mirror images in the planes of the samples."""
    network, mass = untrained_entries(samples, hidden, activation, seed, potential)
    *_, springs, dampers = network.arrays()
    images = Images.of(samples.mirrors)
    *first, constants = _first_layers(network.pairs, hidden[0], seed, mass, True)
    mirrored = replace(
        network,
        parameters=_as_surrogate([*images.of_neurons(*first), constants], springs, dampers),
        # what changes its sign has no mean, though that of so many samples is not 0
        floor=np.where(images.of_entries == 0, network.floor, 0.0),
        even=False,
        hidden=(images.number * hidden[0],),
        mirrors=samples.mirrors,
    )
    return mirrored, mass


def _as_surrogate(layers: list[Array], springs: Array, dampers: Array) -> Array:
    """The parameters of the surrogate, which has the readout of a map the other way round."""
    weights, biases, readout, constants = layers
    parts = weights, biases, readout.T, constants, springs, dampers
    return np.concatenate([part.ravel() for part in parts])


def _polynomial(dataset: Dataset, degrees: Sequence[int], potential: bool) -> PolynomialPortHamiltonian:
    """That of the first of `degrees` with a positive definite mass matrix, or else of the last.

    A degree of more than `LARGEST_TARGET` coefficients is left out, but for the last.
    """
    r, (*others, last) = len(dataset.state_names) // 2, degrees
    small = [degree for degree in others if math.comb(r + degree, degree) * packed_size(r) <= LARGEST_TARGET]
    for degree in (*small, last):
        try:
            return fit_port_hamiltonian(dataset, degree, potential)
        except NotPositiveDefinite as failure:
            found = failure.surrogate
    return found


def _about(
    base: PolynomialPortHamiltonian, dataset: Dataset, hidden: tuple[int, ...], activation: str, seed: int
) -> NetworkPortHamiltonian:
    """Random neurons about the mean of the mass matrix of `base`, and all else that it has."""
    r = base.pairs
    even = not np.any(base.exponents.sum(axis=1) % 2)
    q = dataset.x_train[:, :r] / base.scaling.states(2 * r)[:r]
    mean = _positive_definite(np.mean(base.scaled_mass(q), axis=0))
    springs, rest = (base.scaled_stiffness, None) if base.potential is None else base.potential.split()
    generator = np.random.default_rng(seed)
    (inputs, neurons), _, (entries, _), *_ = NetworkPortHamiltonian.shapes(r, hidden[0], even)
    rows, _ = np.tril_indices(r)
    sizes = READOUT * np.sqrt(np.diag(mean)[rows] / neurons)
    parameters = [
        generator.standard_normal((inputs, neurons)),
        generator.uniform(-1.0, 1.0, neurons),
        sizes[:, None] * generator.standard_normal((entries, neurons)),
        pack(np.array(np.linalg.cholesky((1.0 - FLOOR) * mean), dtype=np.float64)),
        semidefinite_factor(springs),
        semidefinite_factor(base.scaled_damping),
    ]
    return NetworkPortHamiltonian(
        np.concatenate([part.ravel() for part in parameters]),
        base.scaling,
        dataset.state_names,
        dataset.state_units,
        floor=pack(FLOOR * mean),
        even=even,
        hidden=hidden,
        activation=activation,
        potential=rest,
    )


def _positive_definite(matrix: Array) -> Array:
    values, vectors = np.linalg.eigh(matrix)
    nearest: Array = (vectors * np.maximum(values, SMALLEST * values[-1])) @ vectors.T
    return nearest


@dataclass(frozen=True, eq=False)
class FieldLoss:
    """The nmse of the field of `network`, with any parameters, at states `x` and rates `dx` (m, 2r)."""

    network: NetworkPortHamiltonian
    x: Array
    dx: Array

    def loss(self, parameters: Array) -> float:
        """The nmse over all samples."""
        return nmse(replace(self.network, parameters=parameters).derivative(0.0, self.x), self.dx)


def _by_effect(mass: Array) -> Array:
    """Weights of the packed entries of M̂ (m, r, r): an error δM counts by about what M⁻¹ δM is.

    The loss is relative to the variance. With many modes entries differ by powers of ten, and the smallest
    eigenvalue is a small part of the largest entry: relative to each entry alone M would not be positive
    definite.
    """
    inverse = _mean_inverse(mass)
    of_entries = pack(np.outer(inverse, inverse))
    spread, _ = spreads(pack(mass) * np.sqrt(of_entries))
    twice = pack(2.0 - np.eye(len(inverse)))
    found: Array = twice * of_entries / (twice @ spread**2)
    return found


def _mean_inverse(mass: Array) -> Array:
    """(r,) the mean diagonal of M⁻¹ for M (m, r, r); of a matrix that has none, of one near to it."""
    values, vectors = np.linalg.eigh(mass)
    least = NEARLY_ZERO * (float(np.max(np.abs(values))) or 1.0)
    inverse = np.mean(vectors**2 / np.maximum(values, least)[:, None, :], axis=0)
    found: Array = np.sum(inverse, axis=1)
    return found


class EntriesOptimiser:
    """Levenberg–Marquardt on the entries of M̂ (m, r, r) at scaled coordinates `q`. Satisfies `Optimiser`.

    Losses are those of the entries, each relative to its variance; or where M is `known`, by its effect.
    """

    def __init__(self, network: NetworkPortHamiltonian, q: Array, mass: Array, known: bool) -> None:
        weights, biases, readout, constants, *self._others = network.arrays()
        inputs, _ = network.inputs(q)
        target = pack(mass) - network.floor
        entries, activation = network.packed_size, network.activation
        of_entries = _by_effect(mass) if known else 1.0 / (entries * spreads(target)[0] ** 2)
        self._images = None if network.mirrors is None else Images.of(network.mirrors)
        hidden = network.hidden[0] // (1 if self._images is None else self._images.number)
        self._shapes = layer_shapes((len(weights), hidden, entries))
        own = weights[:, :hidden], biases[:hidden], readout[:, :hidden].T, constants
        objective: OneHiddenLayer | MirroredLayer
        if self._images is None:
            objective = OneHiddenLayer.of_map(inputs, target, hidden, activation, of_entries)
        else:
            objective = MirroredLayer(inputs, target, hidden, activation, self._images, of_entries)
        self._method = LevenbergMarquardt(objective, np.concatenate([part.ravel() for part in own]))

    @property
    def finished(self) -> str:
        """Why there is nothing left to do; empty while there is."""
        return self._method.finished

    @property
    def parameters(self) -> Array:
        """Those of the surrogate (n,)."""
        *layers, constants = views(self._method.parameters, self._shapes)
        if self._images is not None:
            layers = [*self._images.of_neurons(*layers)]
        return _as_surrogate([*layers, constants], *self._others)

    def epoch(self) -> float:
        """One accepted step; the loss of the entries after it."""
        return self._method.epoch()

    def state(self) -> dict[str, Array]:
        """That of the method."""
        return self._method.state()

    def restore(self, state: dict[str, Array]) -> None:
        """Go on from a `state`."""
        self._method.restore(state)


class Both:
    """The field's loss, plus that of inverse dynamics times `INVERSE_WEIGHT`. Satisfies `SumOfSquares`."""

    def __init__(self, inverse: PortHamiltonianObjective, forward: PortHamiltonianObjective) -> None:
        self._inverse, self._forward = inverse, forward

    def loss(self, parameters: Array) -> float:
        """The weighted sum of both."""
        return self._forward.loss(parameters) + INVERSE_WEIGHT * self._inverse.loss(parameters)

    def normal_equations(self, parameters: Array) -> NormalEquations:
        """The weighted sum of both."""
        inverse, forward = (part.normal_equations(parameters) for part in (self._inverse, self._forward))
        return NormalEquations(
            forward.loss + INVERSE_WEIGHT * inverse.loss,
            forward.gram + INVERSE_WEIGHT * inverse.gram,
            forward.gradient + INVERSE_WEIGHT * inverse.gradient,
        )

    def bend(self, parameters: Array, step: Array) -> Array:
        """The weighted sum of both."""
        return self._forward.bend(parameters, step) + INVERSE_WEIGHT * self._inverse.bend(parameters, step)


class InverseThenForward:
    """Levenberg–Marquardt on inverse dynamics, from where that ends on the field too. Satisfies `Optimiser`.

    The first is close to linear and finds its way from random weights; the second is what the field's error
    asks for, and would by itself give away slow motions for stiff transients, whose rates are largest.
    Losses returned are those of the field.
    """

    def __init__(
        self, inverse: PortHamiltonianObjective, forward: PortHamiltonianObjective, parameters: Array
    ) -> None:
        self.finished = ""
        self._forward = forward
        self._both = Both(inverse, forward)
        self._done = 0
        self._is_forward = False
        self._method = LevenbergMarquardt(inverse, parameters)

    @property
    def parameters(self) -> Array:
        """The weights (n,)."""
        return self._method.parameters

    def epoch(self) -> float:
        """One accepted step of the stage it is in; the field's loss after it."""
        self._method.epoch()
        self._done += 1
        if self._is_forward:
            self.finished = self._method.finished
        elif self._done >= INVERSE_EPOCHS or self._method.finished:
            self._begin_forward()
        return self._forward.loss(self.parameters)

    def _begin_forward(self) -> None:
        self._is_forward = True
        self._method = LevenbergMarquardt(self._both, self.parameters)

    def state(self) -> dict[str, Array]:
        """The stage and its method's state."""
        return {**self._method.state(), "stage": np.array([self._done, int(self._is_forward)])}

    def restore(self, state: dict[str, Array]) -> None:
        """Go on from a `state`."""
        done, is_forward = state["stage"].tolist()
        self._done = int(done)
        if is_forward and not self._is_forward:
            self._begin_forward()
        self._method.restore(state)
