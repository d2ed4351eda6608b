"""Random initial states, in amplitudes that do not depend on how the modes are normalised."""

import numpy as np

from flexsurr.beam.chain import stiffness_matrix
from flexsurr.beam.projection import ModalBasis
from flexsurr.config.study import HigherModes, InitialConditions
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
        of_q, of_p = _shares(basis, settings.higher_modes)
        return np.hstack([q * of_q / basis.unit_norms, p * of_p * basis.unit_norms])
    springs = stiffness_matrix(basis.structure) @ basis.modes
    return np.hstack([np.linalg.solve(basis.stiffness, (q @ springs).T).T, p @ basis.modes])


def _shares(basis: ModalBasis, higher_modes: HigherModes) -> tuple[Array, Array]:
    """(r,) each: what of their ranges unit-norm modes take, coordinates and momenta; 1 for the first mode.

    At its share a mode has ½ k q² = e ½ k₁ q₁² and p²/(2 m) = e p₁²/(2 m₁), with e = 1 as_energetic and
    e = (ω₁/ω)² as_forced: a force F on each mass-normalised mode stores ½ (F/ω)² in it.
    """
    omega = basis.omega_rad_s
    if higher_modes == "alike":
        return np.ones_like(omega), np.ones_like(omega)
    springs = np.diag(basis.stiffness) / basis.unit_norms**2
    masses = springs / omega**2
    share = np.ones_like(omega) if higher_modes == "as_energetic" else omega[0] / omega
    return share * np.sqrt(springs[0] / springs), share * np.sqrt(masses / masses[0])
