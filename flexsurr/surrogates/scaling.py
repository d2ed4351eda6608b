"""Scales of states and of their rates: canonical, by pair of states, or of each state by itself.

A canonical scaling preserves Hamilton's equations. With q = s_q q̂, p = s_p p̂ and H = s_H Ĥ they keep
their form in the time t̂ = t / s_t,

    dq̂/dt̂ = ∂Ĥ/∂p̂,   dp̂/dt̂ = −∂Ĥ/∂q̂,   s_t = s_q s_p / s_H,

so that the rates follow: q̇ = (s_H / s_p) dq̂/dt̂ and ṗ = (s_H / s_q) dp̂/dt̂. Scales may differ from pair to
pair if the product s_q s_p does not. Scaling each state and each rate by itself breaks the form.
"""

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from flexsurr.simulation.jacobian import implements_jacobian, jacobian
from flexsurr.simulation.rhs import Array, implements_rhs, rhs
from flexsurr.storage import Scales


@dataclass(frozen=True)
class Scaling:
    """The canonical scaling: one scale for all q, one for all p, one for the energy."""

    q: float
    p: float
    energy: float

    def __post_init__(self) -> None:
        _check_positive("q", self.q)
        _check_positive("p", self.p)
        _check_positive("energy", self.energy)

    @property
    def time_s(self) -> float:
        """The unit of the scaled time, s_q s_p / s_H [s]."""
        return self.q * self.p / self.energy

    def states(self, count: int) -> Array:
        """Scale of each of the `count` = 2r states (q, p), shape (2r,)."""
        return np.repeat([self.q, self.p], count // 2)

    def rates(self, count: int) -> Array:
        """Scale of each state's time derivative, shape (2r,): s_H / s_p for q̇, s_H / s_q for ṗ."""
        return np.repeat([self.energy / self.p, self.energy / self.q], count // 2)


@dataclass(frozen=True)
class PairScaling:
    """Canonical, with scales of their own for each pair: s_q,k `q` (r,), and s_q,k s_p,k = `action` for all.

    Two models whose modes differ only in their lengths become the same in it.
    """

    q: tuple[float, ...]
    action: float
    energy: float

    def __post_init__(self) -> None:
        for k, value in enumerate(self.q):
            _check_positive(f"q_{k + 1}", value)
        _check_positive("action", self.action)
        _check_positive("energy", self.energy)

    def states(self, count: int) -> Array:
        """Scale of each of the `count` = 2r states (q, p), shape (2r,)."""
        q = _of_length(self.q, count // 2)
        return np.concatenate([q, self.action / q])

    def rates(self, count: int) -> Array:
        """Scale of each state's time derivative, shape (2r,): that of the state over `action` / `energy`."""
        return self.states(count) * (self.energy / self.action)


@dataclass(frozen=True)
class FeatureScaling:
    """Each state and each rate by itself, `x` and `dx` (2r,): what a learning library does by default.

    Scaled states and rates may be counted from `x_from` and `dx_from` (2r,). The scaled equations of a
    Hamiltonian system are not Hamiltonian.
    """

    x: tuple[float, ...]
    dx: tuple[float, ...]
    x_from: tuple[float, ...] | None = None
    dx_from: tuple[float, ...] | None = None

    def __post_init__(self) -> None:
        for name, values in (("x", self.x), ("dx", self.dx)):
            for k, value in enumerate(values):
                _check_positive(f"{name}_{k + 1}", value)
        for origin in (self.x_from, self.dx_from):
            if origin is not None and (len(origin) != len(self.x) or not np.all(np.isfinite(origin))):
                raise ValueError(f"scaled states and rates count from {len(self.x)} finite numbers each")

    @property
    def energy(self) -> float:
        """Geometric mean of what would be one number, s_q,k s_ṗ,k and s_p,k s_q̇,k, if it were canonical."""
        return float(np.exp(np.mean(np.log([*self.x, *self.dx])) * 2.0))

    def states(self, count: int) -> Array:
        """Scale of each of the `count` = 2r states (q, p), shape (2r,)."""
        return _of_length(self.x, count)

    def rates(self, count: int) -> Array:
        """Scale of each state's time derivative, shape (2r,)."""
        return _of_length(self.dx, count)


StateScaling = Scaling | PairScaling | FeatureScaling


def origins(scaling: StateScaling, count: int) -> tuple[Array, Array]:
    """What the `count` scaled states and their scaled rates are counted from, (2r,) each, in their units."""
    x_from = getattr(scaling, "x_from", None)
    dx_from = getattr(scaling, "dx_from", None)
    return (
        np.zeros(count) if x_from is None else np.array(x_from),
        np.zeros(count) if dx_from is None else np.array(dx_from),
    )


def scaled_states(scaling: StateScaling, x: Array) -> Array:
    """Scaled states of the states `x` (..., 2r)."""
    count = x.shape[-1]
    return np.asarray((x - origins(scaling, count)[0]) / scaling.states(count))


def scaled_rates(scaling: StateScaling, dx: Array) -> Array:
    """Scaled rates of the rates `dx` (..., 2r)."""
    count = dx.shape[-1]
    return np.asarray((dx - origins(scaling, count)[1]) / scaling.rates(count))


def rates_of(scaling: StateScaling, field: Array) -> Array:
    """The rates (..., 2r) whose scaled rates are `field`."""
    count = field.shape[-1]
    return np.asarray(scaling.rates(count) * field + origins(scaling, count)[1])


def canonical_scaling(scales: Scales) -> Scaling:
    """Scaling of samples of these `scales` of 2r states and 2r derivatives.

    The largest |q| and |p| become one; the energy's scale balances both equations:
    s_H² = s_p rms(q̇) · s_q rms(ṗ). Raises ValueError where q, p or a derivative is zero throughout.
    """
    q, p = (float(np.max(part)) for part in np.split(np.array(scales.largest), 4)[:2])
    of_dq, of_dp = (float(np.sqrt(np.mean(part**2))) for part in np.split(scales.root_mean_square, 4)[2:])
    return Scaling(q=q, p=p, energy=float(np.sqrt(p * of_dq * q * of_dp)))


def pair_scaling(scales: Scales) -> PairScaling:
    """Pair scaling of samples of these `scales` of 2r states and 2r derivatives.

    The largest |q_k| of each pair and the largest |p_k| of any become one; the unit of time is that of the
    rates q̇_k, the root mean square of all. Raises ValueError where a coordinate or all rates are zero.
    """
    q, p = np.split(np.array(scales.largest), 4)[:2]
    action = float(np.max(q * p))
    _check_positive("q", float(np.min(q)))
    rates = np.split(scales.root_mean_square, 4)[2]
    frequency = float(np.sqrt(np.mean((rates / q) ** 2)))
    return PairScaling(q=tuple(q.tolist()), action=action, energy=action * frequency)


def feature_scaling(scales: Scales) -> FeatureScaling:
    """Standard deviation of each state and of each rate (2r,); ValueError where one is zero."""
    deviations = scales.standard_deviation
    count = len(deviations) // 2
    return FeatureScaling(x=deviations[:count], dx=deviations[count:])


def min_max_scaling(scales: Scales) -> FeatureScaling:
    """0 to 1 from least to largest of each state and rate; ValueError where one does not vary."""
    low, spans = np.array(scales.low), np.subtract(scales.high, scales.low)
    x_from, dx_from = (tuple(part.tolist()) for part in np.split(low, 2))
    x, dx = (tuple(part.tolist()) for part in np.split(spans, 2))
    return FeatureScaling(x=x, dx=dx, x_from=x_from, dx_from=dx_from)


def _check_positive(name: str, value: float) -> None:
    if not (np.isfinite(value) and value > 0.0):
        raise ValueError(f"the scale of {name} must be finite and positive, not {value}")


def _of_length(values: tuple[float, ...], count: int) -> Array:
    if len(values) != count:
        raise ValueError(f"{len(values)} scales do not fit {count} states or coordinates")
    return np.array(values)


class ScaledKernel(NamedTuple):
    """ẋ_i = rates_i f_i((x − x_from) / s) + dx_from_i for any kernel of f; all (d,)."""

    field: Any
    inverse_states: Array
    rates: Array
    x_from: Array
    dx_from: Array


def scaled_kernel(
    field: NamedTuple, work_size: int, scaling: StateScaling, count: int
) -> tuple[NamedTuple, int]:
    """The kernel of `count` states whose scaled field is that of the kernel `field`, and its workspace.

    For fields into whose weights the scales cannot be folded: those of gradients, unless the scaling is
    canonical and the gradient turned by Hamilton's equations.
    """
    rates = np.array(scaling.rates(count))
    kernel = ScaledKernel(field, 1.0 / scaling.states(count), rates, *origins(scaling, count))
    return kernel, work_size + 2 * count


@implements_rhs(ScaledKernel, inline=False)
def _scaled(kernel, t, x, dx, work):
    d = x.size
    for i in range(d):
        work[i] = (x[i] - kernel.x_from[i]) * kernel.inverse_states[i]
    rhs(kernel.field, t, work[:d], dx, work[d:])
    for i in range(d):
        dx[i] = dx[i] * kernel.rates[i] + kernel.dx_from[i]


@implements_jacobian(ScaledKernel)
def _jacobian_of_scaled(kernel, t, x, dx, jac, work):
    d = x.size
    for i in range(d):
        work[i] = (x[i] - kernel.x_from[i]) * kernel.inverse_states[i]
        work[d + i] = (dx[i] - kernel.dx_from[i]) / kernel.rates[i]
    taken = jacobian(kernel.field, t, work[:d], work[d : 2 * d], jac, work[2 * d :])
    for i in range(d):
        for j in range(d):
            jac[i, j] *= kernel.rates[i] * kernel.inverse_states[j]
    return taken
