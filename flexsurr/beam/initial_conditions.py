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
    n, r = basis.modes.shape
    states = np.empty((count, 2 * r))
    drawn = r if settings.kind == "modal" else n
    for row, k in zip(states, range(first, first + count), strict=True):
        generator = np.random.default_rng([seed, k])
        q = np.deg2rad(generator.uniform(settings.q_min_deg, settings.q_max_deg, drawn))
        p = generator.uniform(settings.p_min_kg_m2_s, settings.p_max_kg_m2_s, drawn)
        if settings.kind == "modal":
            row[:r], row[r:] = q / basis.unit_norms, p * basis.unit_norms
        else:
            springs = basis.modes.T @ stiffness_matrix(basis.structure)
            row[:r], row[r:] = np.linalg.solve(basis.stiffness, springs @ q), basis.modes.T @ p
    return states
