"""Hamiltonian neural networks: fields made of the gradients of scalars, each a network of its own.

`HNN` (loss: eq. 11) is Hamilton's equations of a network H(q, p), `DissipativeHNN` (eq. 12) has a dissipation
function beside it.
"""

from dataclasses import dataclass
from typing import ClassVar, NamedTuple

import numpy as np
from numba import njit

from flexsurr.simulation.dimension import LANES
from flexsurr.simulation.jacobian import implements_jacobian
from flexsurr.simulation.rhs import FLOATING_POINT, Array, implements_rhs
from flexsurr.simulation.side_by_side import implements_rhs_of_block
from flexsurr.surrogates.activations import curvature, slope, two_slopes, value
from flexsurr.surrogates.layers import Dense, Network, Shapes, add_products, back, forward, offset
from flexsurr.surrogates.scaling import FeatureScaling, scaled_kernel, scaled_states
from flexsurr.surrogates.surrogate import symplectic


@dataclass(frozen=True, eq=False)
class ScalarNetworks(Network):
    """As many scalars Σ c σ(… σ(W₁ x + b₁) …) as `networks`, of equal widths, without a constant.

    A constant would not move the field. The first scalar is the Hamiltonian. For one hidden layer the
    gradients need σ′ only.
    """

    @classmethod
    def readout_shapes(cls, states: int, neurons: int) -> Shapes:
        """A vector c."""
        return [(neurons,)]

    def scalar(self, number: int) -> Dense:
        """Scalar `number` of scaled states, as its single output."""
        *hidden, readout = self.network_arrays(number)
        return Dense(self.sigma, hidden, readout[:, None])

    def scaled_scalar(self, x: Array, number: int) -> Array:
        """Scalar `number` of scaled states, (..., 2r) -> (...)."""
        return self.scalar(number)(x)[..., 0]

    def scaled_gradient(self, x: Array, number: int) -> Array:
        """Gradient of scalar `number` at scaled states, (..., 2r) -> (..., 2r)."""
        return self.scalar(number).jacobian(x)[..., 0, :]

    def energy(self, x: Array) -> Array:
        """H(x) − H(0), (..., 2r) -> (...), in the product of the units of q and p per second.

        Where the scaling is not canonical, the states' equations are not Hamilton's of this energy.
        """
        origin = np.zeros(len(self.state_names))
        scaled, scaled_origin = scaled_states(self.scaling, x), scaled_states(self.scaling, origin)
        return self.scaling.energy * (self.scaled_scalar(scaled, 0) - self.scaled_scalar(scaled_origin, 0))


@njit(fastmath=FLOATING_POINT, error_model="numpy")
def gradient_of_scalar(activation, widths, parameters, weights, x, work):
    """The gradient by `x` of the scalar network whose parameters begin at `weights`, left at `work`'s start.

    The workspace holds the inputs, then for each layer the arguments and the values of σ.
    """
    last = len(widths) - 1
    for j in range(x.size):
        work[j] = x[j]
    values = offset(0)
    for layer in range(1, last + 1):
        n = offset(widths[layer - 1])
        m = offset(widths[layer])
        z = values + n
        forward(parameters, weights, n, m, work, values, z)
        values = z + m
        weights += n * m + m
        if layer < last:
            for k in range(m):
                work[values + k] = value(activation, work[z + k])
    m = offset(widths[last])
    for k in range(m):
        work[values + k] = parameters[weights + k]
    # back: the derivatives of the scalar by each layer's values, then by its arguments, in their places
    for layer in range(last, 0, -1):
        n = offset(widths[layer - 1])
        m = offset(widths[layer])
        z = values - m
        for k in range(m):
            work[z + k] = work[values + k] * slope(activation, work[z + k])
        values = z - n
        weights -= n * m + m
        back(parameters, weights, n, m, work, z, values)


# What follows keeps five rows of numbers for each hidden layer, after the d inputs: σ″, values and later
# their tangents, σ′, derivatives of the scalar by the values, tangents of the arguments.
_ROWS = 5


@njit(fastmath=FLOATING_POINT, error_model="numpy")
def prepare_second_derivatives(activation, widths, parameters, weights, x, work):
    """Sweep forth and back once at `x`, for `gradient_along`."""
    last = len(widths) - 1
    for j in range(x.size):
        work[j] = x[j]
    inputs = offset(0)
    row = offset(widths[0])
    for layer in range(1, last + 1):
        n = offset(widths[layer - 1])
        m = offset(widths[layer])
        forward(parameters, weights, n, m, work, inputs, row)
        weights += n * m + m
        inputs = row + m
        if layer < last:
            for k in range(m):
                work[inputs + k] = value(activation, work[row + k])
        for k in range(m):
            work[inputs + m + k] = slope(activation, work[row + k])
        for k in range(m):
            work[row + k] = curvature(activation, work[row + k])
        row += offset(_ROWS) * m
    m = offset(widths[last])
    row -= offset(_ROWS) * m
    for k in range(m):
        work[row + offset(3) * m + k] = parameters[weights + k]
    for layer in range(last, 1, -1):
        n = offset(widths[layer - 1])
        m = offset(widths[layer])
        weights -= n * m + m
        tangents = row + offset(4) * m
        for k in range(m):
            work[tangents + k] = work[tangents - m + k] * work[row + offset(2) * m + k]
        row -= offset(_ROWS) * n
        back(parameters, weights, n, m, work, tangents, row + offset(3) * n)


@njit(fastmath=FLOATING_POINT, error_model="numpy")
def gradient_along(widths, parameters, weights, direction, work):
    """∂/∂x_direction of the gradient of the scalar, (d,), left at `work`'s start."""
    last = len(widths) - 1
    row = offset(widths[0])
    n = row
    m = offset(widths[1])
    for k in range(m):
        work[row + offset(4) * m + k] = parameters[weights + direction * m + k]
    for layer in range(2, last + 1):
        weights += n * m + m
        n = m
        m = offset(widths[layer])
        by_values = row + n
        for k in range(n):
            work[by_values + k] = work[row + offset(2) * n + k] * work[row + offset(4) * n + k]
        row += offset(_ROWS) * n
        for k in range(m):
            work[row + offset(4) * m + k] = 0.0
        add_products(parameters, weights, n, m, work, by_values, row + offset(4) * m)
    for layer in range(last, 0, -1):
        n = offset(widths[layer - 1])
        m = offset(widths[layer])
        tangents = row + offset(4) * m
        for k in range(m):
            work[tangents + k] *= work[row + offset(3) * m + k] * work[row + k]
        if layer < last:
            for k in range(m):
                work[tangents + k] += work[row + m + k] * work[row + offset(2) * m + k]
        if layer > 1:
            row -= offset(_ROWS) * n
            back(parameters, weights, n, m, work, tangents, row + n)
            weights -= offset(widths[layer - 2]) * n + n
        else:
            back(parameters, weights, n, m, work, tangents, offset(0))


@dataclass(frozen=True, eq=False)
class HNN(ScalarNetworks):
    """q̇ = ∂H/∂p, ṗ = −∂H/∂q with H = Σ c σ(… σ(W₁ x + b₁) …): eq. 2 without load or dissipation.

    The scaled field is Hamiltonian; that in the units of the states is so if the scaling is canonical.
    """

    architecture: ClassVar[str] = "hnn"

    def scaled_field(self, x: Array) -> Array:
        """Hamilton's equations of Ĥ."""
        return symplectic(self.scaled_gradient(x, 0))

    def scaled_kernel(self, parameters: Array) -> "HNNKernel":
        """The scaled field with these weights, for compiled code."""
        return HNNKernel(self.sigma.tag, self.widths, parameters)

    def kernel(self) -> tuple[NamedTuple, int]:
        """A single loop for one hidden layer over one pair (q, p), else layer by layer."""
        work_size = self.widths[0] + _ROWS * sum(self.hidden)
        if isinstance(self.scaling, FeatureScaling):
            unscaled = self.scaled_kernel(self.parameters.copy())
            return scaled_kernel(unscaled, work_size, self.scaling, self.widths[0])
        states = self.scaling.states(len(self.state_names))
        inner, *others, readout = self.arrays()
        inner = inner / states[:, None]
        readout = readout * self.scaling.energy
        if self.widths == (2, self.hidden[0]):
            return PhasePlaneHNN(
                self.sigma.tag, inner[0].copy(), inner[1].copy(), others[0].copy(), readout
            ), 0
        parameters = np.concatenate([array.ravel() for array in (inner, *others, readout)])
        return self.scaled_kernel(parameters), work_size


class PhasePlaneHNN(NamedTuple):
    """One hidden layer over a single pair (q, p): weights of q and of p, biases, readout, each (n,)."""

    activation: NamedTuple
    w_q: Array
    w_p: Array
    bias: Array
    readout: Array


@implements_rhs(PhasePlaneHNN)
def _phase_plane_hnn(kernel, t, x, dx, work):
    activation, w_q, w_p, bias, readout = kernel
    q, p = x[0], x[1]
    dh_dq = 0.0
    dh_dp = 0.0
    # each neuron by itself: to share a division between two, as a block does, makes the sums wait for longer
    for k in range(offset(bias.size)):
        a = readout[k] * slope(activation, w_q[k] * q + w_p[k] * p + bias[k])
        dh_dq += a * w_q[k]
        dh_dp += a * w_p[k]
    dx[0] = dh_dp
    dx[1] = -dh_dq


@implements_jacobian(PhasePlaneHNN)
def _jacobian_of_phase_plane_hnn(kernel, t, x, dx, jac, work):
    activation, w_q, w_p, bias, readout = kernel
    q, p = x[0], x[1]
    by_qq = by_qp = by_pp = 0.0
    for k in range(bias.size):
        a = readout[k] * curvature(activation, w_q[k] * q + w_p[k] * p + bias[k])
        by_qq += a * w_q[k] * w_q[k]
        by_qp += a * w_q[k] * w_p[k]
        by_pp += a * w_p[k] * w_p[k]
    jac[0, 0], jac[0, 1] = by_qp, by_pp
    jac[1, 0], jac[1, 1] = -by_qq, -by_qp
    return 0


@implements_rhs_of_block(PhasePlaneHNN)
def _block_of_hnn(kernel, t, x, dx, work):
    activation, w_q, w_p, bias, readout = kernel
    for b in range(2 * LANES):
        dx[b] = 0.0
    n = bias.size
    for k in range(1, n, 2):
        a_q, a_p, a_b, a_c = w_q[k - 1], w_p[k - 1], bias[k - 1], readout[k - 1]
        e_q, e_p, e_b, e_c = w_q[k], w_p[k], bias[k], readout[k]
        for b in range(LANES):
            q, p = x[b], x[LANES + b]
            a, e = two_slopes(activation, a_q * q + a_p * p + a_b, e_q * q + e_p * p + e_b)
            a *= a_c
            e *= e_c
            dx[b] += a * a_p + e * e_p
            dx[LANES + b] -= a * a_q + e * e_q
    if n % 2 == 1:
        a_q, a_p, a_b, a_c = w_q[n - 1], w_p[n - 1], bias[n - 1], readout[n - 1]
        for b in range(LANES):
            a = a_c * slope(activation, a_q * x[b] + a_p * x[LANES + b] + a_b)
            dx[b] += a * a_p
            dx[LANES + b] -= a * a_q


class HNNKernel(NamedTuple):
    """Any number of states and hidden layers; widths and parameters as in `Network`."""

    activation: NamedTuple
    widths: tuple[int, ...]
    parameters: Array
    networks: int = 1


@implements_rhs(HNNKernel, inline=False)
def _hnn(kernel, t, x, dx, work):
    gradient_of_scalar(kernel.activation, kernel.widths, kernel.parameters, offset(0), x, work)
    r = x.size // 2
    for j in range(r):
        dx[j] = work[r + j]
        dx[r + j] = -work[j]


@implements_jacobian(HNNKernel)
def _jacobian_of_hnn(kernel, t, x, dx, jac, work):
    activation, widths, parameters, _ = kernel
    prepare_second_derivatives(activation, widths, parameters, offset(0), x, work)
    r = x.size // 2
    for j in range(x.size):
        gradient_along(widths, parameters, offset(0), offset(j), work)
        for i in range(r):
            jac[i, j] = work[r + i]
            jac[r + i, j] = -work[i]
    return 0


@dataclass(frozen=True, eq=False)
class DissipativeHNN(ScalarNetworks):
    """q̇ = ∂H/∂p + ∂D/∂q, ṗ = −∂H/∂q + ∂D/∂p (in eq. 12), with H and D two separate networks (Fig. 7).

    With r ≥ 2 not every field has this form; and H need not be the energy: adding a holomorphic function of
    q + ip to D − iH leaves the field as it is.
    """

    architecture: ClassVar[str] = "dissipative_hnn"
    networks: ClassVar[int] = 2

    def scaled_field(self, x: Array) -> Array:
        """Hamilton's equations of Ĥ, and the gradient of D̂."""
        return symplectic(self.scaled_gradient(x, 0)) + self.scaled_gradient(x, 1)

    def scaled_kernel(self, parameters: Array) -> "DissipativeHNNKernel":
        """The scaled field with these weights, for compiled code."""
        return DissipativeHNNKernel(self.sigma.tag, self.widths, parameters)

    def kernel(self) -> tuple[NamedTuple, int]:
        """Layer by layer, one network after the other; the scales are applied to inputs and outputs."""
        size = self.widths[0] + _ROWS * sum(self.hidden)
        return scaled_kernel(self.scaled_kernel(self.parameters.copy()), size, self.scaling, self.widths[0])


class DissipativeHNNKernel(NamedTuple):
    """Any number of states and hidden layers; widths and parameters as in `Network`."""

    activation: NamedTuple
    widths: tuple[int, ...]
    parameters: Array
    networks: int = DissipativeHNN.networks


@implements_rhs(DissipativeHNNKernel, inline=False)
def _dissipative_hnn(kernel, t, x, dx, work):
    activation, widths, parameters, networks = kernel
    r = x.size // 2
    gradient_of_scalar(activation, widths, parameters, offset(0), x, work)
    for j in range(r):
        dx[j] = work[r + j]
        dx[r + j] = -work[j]
    gradient_of_scalar(activation, widths, parameters, offset(parameters.size // networks), x, work)
    for j in range(x.size):
        dx[j] += work[j]


@implements_jacobian(DissipativeHNNKernel)
def _jacobian_of_dissipative_hnn(kernel, t, x, dx, jac, work):
    activation, widths, parameters, networks = kernel
    r = x.size // 2
    prepare_second_derivatives(activation, widths, parameters, offset(0), x, work)
    for j in range(x.size):
        gradient_along(widths, parameters, offset(0), offset(j), work)
        for i in range(r):
            jac[i, j] = work[r + i]
            jac[r + i, j] = -work[i]
    second = offset(parameters.size // networks)
    prepare_second_derivatives(activation, widths, parameters, second, x, work)
    for j in range(x.size):
        gradient_along(widths, parameters, second, offset(j), work)
        for i in range(x.size):
            jac[i, j] += work[i]
    return 0
