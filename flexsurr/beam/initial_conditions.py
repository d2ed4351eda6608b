"""Random initial states, in amplitudes that do not depend on how the modes are normalised."""

import numpy as np

from flexsurr.beam.chain import stiffness_matrix
from flexsurr.beam.projection import ModalBasis
from flexsurr.config.study import InitialConditions
from flexsurr.simulation.rhs import Array


def draw_initial_conditions(
    basis: ModalBasis, settings: InitialConditions, seed: int, first: int, count: int
) -> Array:
    """(count, 2r) states (η, p) of trajectories `first` … `first + count − 1`.

    Trajectory k is drawn by itself from (seed, k), so any shard can be made alone. `modal` draws for the
    coordinates of unit-norm modes; `joint` draws for every joint and projects,
    η = (Φᵀ K Φ)⁻¹ Φᵀ K q, p = Φᵀ p. ValueError for negative numbers.
    """
    if seed < 0 or first < 0 or count < 0:
        raise ValueError(f"seed, first and count must not be negative: {seed}, {first}, {count}")
    states = np.empty((count, 2 * basis.modes.shape[1]))
    drawn = drawn_amplitudes(basis, settings)
    # one by one: rounding in a product of matrices depends on how many rows they have
    for row, k in zip(states, range(first, first + count), strict=True):
        row[:] = initial_states(
            basis, settings, np.random.default_rng([seed, k]).uniform(size=(1, 2 * drawn))
        )
    return states


def drawn_amplitudes(basis: ModalBasis, settings: InitialConditions) -> int:
    """How many coordinates are drawn, and as many momenta: r of the modes or n of the joints."""
    return int(basis.modes.shape[1 if settings.kind == "modal" else 0])


def initial_states(basis: ModalBasis, settings: InitialConditions, unit: Array) -> Array:
    """(k, 2r) states (η, p) for numbers `unit` (k, 2 · drawn_amplitudes) from 0 to 1, coordinates first."""
    of_q, of_p = np.split(unit, 2, axis=1)
    q = np.deg2rad(settings.q_min_deg + (settings.q_max_deg - settings.q_min_deg) * of_q)
    p = settings.p_min_kg_m2_s + (settings.p_max_kg_m2_s - settings.p_min_kg_m2_s) * of_p
    if settings.kind == "modal":
        return np.hstack([q / basis.unit_norms, p * basis.unit_norms])
    springs = stiffness_matrix(basis.structure) @ basis.modes
    return np.hstack([np.linalg.solve(basis.stiffness, (q @ springs).T).T, p @ basis.modes])
