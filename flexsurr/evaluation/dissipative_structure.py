"""Whether a field can be that of a D-HNN at all: the symmetries that the field in eq. 12 has."""

from dataclasses import dataclass

import numpy as np

from flexsurr.simulation.rhs import Array, Model

_STEP = 1e-6
"""Of central differences, relative to the size of the states."""


@dataclass(frozen=True)
class Asymmetry:
    """How far a field is from the fields in eq. 12: 0 where it is one of them.

    Root mean square over the states of ‖A − Aᵀ‖, over that of the two terms whose sum A is (Frobenius
    norms), for the two matrices A that have to be symmetric: `mixed` is ∂q̇/∂q + (∂ṗ/∂p)ᵀ, `direct` is
    ∂ṗ/∂q − (∂q̇/∂p)ᵀ.
    """

    mixed: float
    direct: float


def dissipative_asymmetry(model: Model, states: Array) -> Asymmetry:
    """The asymmetry of a field of states (q, p) at `states` (k, 2r), r ≥ 2.

    For a D-HNN, q̇ = ∂H/∂p + ∂D/∂q and ṗ = −∂H/∂q + ∂D/∂p, the mixed derivatives of H cancel in `mixed`,
    those of D in `direct`: D_qq + D_pp and −H_qq − H_pp are left, which are symmetric. States are scaled
    canonically, by one scale for all q and one for all p (their largest sizes), since the two terms of
    `direct` have different units. ValueError for r = 1, where every field satisfies the condition.
    """
    r = states.shape[1] // 2
    if r < 2:
        raise ValueError("with a single mode every field is that of a D-HNN")
    scale = np.repeat([np.abs(states[:, :r]).max(), np.abs(states[:, r:]).max()], r)
    squares = np.zeros(4)
    for state in states:
        columns = [
            model.derivative(0.0, state + _STEP * scale * unit)
            - model.derivative(0.0, state - _STEP * scale * unit)
            for unit in np.eye(2 * r)
        ]
        jacobian = np.array(columns).T / (2.0 * _STEP * scale[:, None])  # scaled states and rates
        squares += [
            odd_and_size
            for one, other in (
                (jacobian[:r, :r], jacobian[r:, r:].T),
                (jacobian[r:, :r], -jacobian[:r, r:].T),
            )
            for odd_and_size in (_odd(one + other), np.sum(one**2) + np.sum(other**2))
        ]
    odd_mixed, mixed, odd_direct, direct = np.sqrt(squares)
    return Asymmetry(float(odd_mixed / mixed), float(odd_direct / direct))


def _odd(matrix: Array) -> float:
    """‖A − Aᵀ‖²."""
    return float(np.sum((matrix - matrix.T) ** 2))
