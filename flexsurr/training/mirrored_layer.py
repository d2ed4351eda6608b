"""Normal equations of neurons that come with their mirror images (`surrogates.mirrored_mass`).

Sums over images are formed first: with V_ke the readout of entry e, of parity c,

    y_e = Λ_e + Σ_k V_ke F_ck        F_ck = Σ_g χ_c(g) σ(z_gk)        D_ck = Σ_g χ_c(g) σ′(z_gk)
    ∂F_ck/∂W_jk = x_j D_c'k

with c' the parity of e and of coordinate j together. Entries of one parity therefore share their features and
slopes, and JᵀJ is made of one product of slopes and one of features for each parity.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from flexsurr.simulation.rhs import Array
from flexsurr.surrogates.activations import activation_function
from flexsurr.surrogates.layers import layer_shapes, views
from flexsurr.surrogates.mirrored_mass import Images
from flexsurr.training.levenberg_marquardt import NormalEquations, second_difference, settling


@dataclass(frozen=True, eq=False)
class MirroredLayer:
    """A weighted mean squared error of packed matrices `y` (m, entries) at coordinates `x` (m, r).

    `output_weights` (entries,) are those of the entries. `parameters` are weights (r, h), biases (h,),
    readout (h, entries) and constants (entries,); constants of entries that change their sign stay as they
    are. Satisfies `SumOfSquares`, `Bending` and `Separable`.
    """

    x: Array
    y: Array
    hidden: int
    activation: str
    images: Images
    output_weights: Array

    @cached_property
    def _with_ones(self) -> tuple[Array, NDArray[np.int64]]:
        """x̃ = (x, 1) (m, r + 1), and the parity of each column: that of 1 is 0."""
        parities = np.concatenate([self.images.of_coordinates, np.zeros(1, dtype=np.int64)])
        return np.hstack([self.x, np.ones((len(self.x), 1))]), parities

    def weights(self, parameters: Array) -> list[Array]:
        """Views of the parameters in their shapes."""
        return views(parameters, layer_shapes((self.x.shape[1], self.hidden, self.y.shape[1])))

    def _features(self, parameters: Array) -> tuple[Array, Array]:
        """F and D (parity, m, h)."""
        weights, biases, *_ = self.weights(parameters)
        x, parities = self._with_ones
        layer = np.vstack([weights, biases])
        every = range(self.images.number)
        z = self.images.transform(np.array([x[:, parities == c] @ layer[parities == c] for c in every]))
        sigma = activation_function(self.activation)
        return self.images.transform(sigma.value(z)), self.images.transform(sigma.slope(z))

    def outputs(self, parameters: Array) -> Array:
        """The matrices (m, entries)."""
        *_, readout, constants = self.weights(parameters)
        return self._read(self._features(parameters)[0], readout) + constants

    def _read(self, features: Array, readout: Array) -> Array:
        y = np.empty_like(self.y)
        for c, members in self._members:
            y[:, members] = features[c] @ readout[:, members]
        return y

    @cached_property
    def _members(self) -> list[tuple[int, NDArray[np.intp]]]:
        """The entries of each parity that there is."""
        found = [(c, np.flatnonzero(self.images.of_entries == c)) for c in range(self.images.number)]
        return [(c, members) for c, members in found if len(members)]

    def loss(self, parameters: Array) -> float:
        """The weighted mean squared error."""
        return float(np.mean((self.outputs(parameters) - self.y) ** 2, axis=0) @ self.output_weights)

    def settled(self, parameters: Array) -> Array:
        """The same with readout and constants at their least squares."""
        found = parameters.copy()
        *_, readout, constants = self.weights(found)
        features, _ = self._features(parameters)
        errors = self._read(features, readout) + constants - self.y
        for c, members in self._members:
            seen = self._seen(features, c)
            moved = settling(seen.T @ seen, seen.T @ errors[:, members])
            readout[:, members] += moved[: self.hidden]
            if c == 0:
                constants[members] += moved[-1]
        return found

    def _seen(self, features: Array, c: int) -> Array:
        """What entries of parity c read: their features, and 1 where they may have a constant."""
        return features[c] if c else np.hstack([features[c], np.ones((len(self.x), 1))])

    def normal_equations(self, parameters: Array) -> NormalEquations:
        """JᵀJ and Jᵀr."""
        *_, readout, constants = self.weights(parameters)
        features, slopes = self._features(parameters)
        errors = self._read(features, readout) + constants - self.y
        pulled = errors * self.output_weights / len(self.x)
        x, parities = self._with_ones
        (m, inputs), (h, entries) = x.shape, readout.shape
        inner = inputs * h
        gram = np.zeros((parameters.size, parameters.size))
        # the readout of neuron k for entry e stands at k · entries + e, constants are the last row
        places = inner + np.arange((h + 1) * entries).reshape(h + 1, entries)
        for c, members in self._members:
            seen = self._seen(features, c)
            tilted = (x[:, :, None] * slopes[parities ^ c].transpose(1, 0, 2)).reshape(m, inner)
            of_inner, between, outer = tilted.T @ tilted, tilted.T @ seen, seen.T @ seen
            own, importance = readout[:, members], self.output_weights[members] / m
            gram[:inner, :inner] += of_inner * np.tile((own * importance) @ own.T, (inputs, inputs))
            for e, weight, column in zip(members, importance, own.T, strict=True):
                at = places[: len(outer), e]
                gram[:inner, at] = between * (weight * np.tile(column, inputs))[:, None]
                gram[np.ix_(at, at)] = weight * outer
        gram[inner:, :inner] = gram[:inner, inner:].T
        gradient = self._pulled_back(features, slopes, readout, pulled)
        return NormalEquations(float(np.sum(pulled * errors)), gram, gradient)

    def bend(self, parameters: Array, step: Array) -> Array:
        """Jᵀr″ (n,), of the second derivative r″ of the residuals along `step` (n,)."""
        second = second_difference(self.outputs(parameters), self.outputs, parameters, step)
        *_, readout, _ = self.weights(parameters)
        pulled = second * self.output_weights / len(self.x)
        return self._pulled_back(*self._features(parameters), readout, pulled)

    def _pulled_back(self, features: Array, slopes: Array, readout: Array, pulled: Array) -> Array:
        """Jᵀ `pulled` (n,), of what pulls at the outputs (m, entries)."""
        x, parities = self._with_ones
        of_layer, of_readout = np.zeros((x.shape[1], self.hidden)), np.empty_like(readout)
        for c, members in self._members:
            of_readout[:, members] = features[c].T @ pulled[:, members]
            back = pulled[:, members] @ readout[:, members].T
            of_layer += np.array(
                [column @ (back * slopes[p ^ c]) for column, p in zip(x.T, parities, strict=True)]
            )
        constants = np.where(self.images.of_entries == 0, pulled.sum(axis=0), 0.0)
        return np.concatenate([of_layer.ravel(), of_readout.ravel(), constants])
