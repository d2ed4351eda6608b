"""The canonical scaling: one scale for all q, one for all p, one for the energy.

Scaling each state by itself would not preserve Hamilton's equations. With q = s_q q̂, p = s_p p̂ and
H = s_H Ĥ they keep their form in the time t̂ = t / s_t,

    dq̂/dt̂ = ∂Ĥ/∂p̂,   dp̂/dt̂ = −∂Ĥ/∂q̂,   s_t = s_q s_p / s_H,

so that the rates follow: q̇ = (s_H / s_p) dq̂/dt̂ and ṗ = (s_H / s_q) dp̂/dt̂.
"""

from dataclasses import dataclass

import numpy as np

from flexsurr.simulation.rhs import Array


@dataclass(frozen=True)
class Scaling:
    """Scales of q, of p and of the energy, in the units of the states and their product per second."""

    q: float
    p: float
    energy: float

    def __post_init__(self) -> None:
        for name, value in (("q", self.q), ("p", self.p), ("energy", self.energy)):
            if not (np.isfinite(value) and value > 0.0):
                raise ValueError(f"the scale of {name} must be finite and positive, not {value}")

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


def canonical_scaling(x: Array, dx: Array) -> Scaling:
    """Scaling of states `x` (m, 2r) and their derivatives `dx` (m, 2r).

    The largest |q| and |p| become one; the energy's scale balances both equations:
    s_H² = s_p rms(q̇) · s_q rms(ṗ). Raises ValueError where q, p or a derivative is zero throughout.
    """
    r = x.shape[1] // 2
    q, p = float(np.max(np.abs(x[:, :r]))), float(np.max(np.abs(x[:, r:])))
    rates = float(np.sqrt(np.mean(dx[:, :r] ** 2))), float(np.sqrt(np.mean(dx[:, r:] ** 2)))
    return Scaling(q=q, p=p, energy=float(np.sqrt(p * rates[0] * q * rates[1])))
