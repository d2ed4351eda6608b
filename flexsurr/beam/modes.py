"""Natural frequencies and modes about an equilibrium (eq. 9), and the basis of a reduced model."""

import numpy as np
from scipy.linalg import eigh

from flexsurr.beam.chain import chain, check_coordinates
from flexsurr.beam.equilibrium import EquilibriumNotFound, find_equilibrium, tangent_stiffness
from flexsurr.beam.kinematics import configuration, generalised_forces, mass_matrix, velocities
from flexsurr.beam.loads import Acting, Load, has_potential, static_load
from flexsurr.beam.projection import ModalBasis
from flexsurr.config.structure import Structure
from flexsurr.config.study import Reduction
from flexsurr.simulation.rhs import Array

_ROUNDING = 1e-10  # of a Coriolis force, beside the largest that there might be


def natural_modes(structure: Structure, equilibrium: Array, load: Load | None = None) -> tuple[Array, Array]:
    """Frequencies ω (n,) [rad/s], ascending, and mass-normalised modes (n, n), columns (eq. 9).

    The stiffness is the tangent one about `equilibrium` (n,): springs less the change of the generalised
    forces of gravity and `load` with q. Each mode's sign lifts the tip; where the tip does not move in
    z, the mode's largest component is positive. EquilibriumNotFound where the equilibrium is unstable;
    ValueError under a load without a potential, whose motion has no such modes, and where the clamp turns and
    Coriolis forces act on small motions: those of a straight chain across its axis they leave alone.
    """
    q = check_coordinates(structure, equilibrium, "equilibrium")
    mass = mass_matrix(structure, q)
    _check_motion(structure, q, static_load(structure, load), mass)
    squares, modes = eigh(tangent_stiffness(structure, q, load), mass)
    if squares[0] < 0.0:
        raise EquilibriumNotFound(
            f"{structure.name}: the equilibrium is unstable (ω² = {squares[0]:.3g} rad²/s²)"
        )
    return np.sqrt(squares), modes * _signs(structure, q, modes)


def reduce(structure: Structure, reduction: Reduction) -> ModalBasis:
    """The basis of eq. 10: `reduction.modes` modes about the undeformed shape or the equilibrium.

    The undeformed shape is an equilibrium without gravity, and its modes are taken so. ValueError for more
    modes than coordinates.
    """
    if reduction.modes > structure.coordinates:
        raise ValueError(
            f"modes: {reduction.modes} modes asked of {structure.name}, which has "
            f"{structure.coordinates} coordinates"
        )
    if reduction.about == "equilibrium":
        equilibrium = find_equilibrium(structure)
        omega, modes = natural_modes(structure, equilibrium)
    else:
        equilibrium = np.zeros(structure.coordinates)
        omega, modes = natural_modes(structure.model_copy(update={"gravity_m_s2": 0.0}), equilibrium)
    modes = modes[:, : reduction.modes]
    if reduction.normalisation == "unit":
        modes = modes / np.linalg.norm(modes, axis=0)
    return ModalBasis.of(structure, equilibrium, modes, omega[: reduction.modes], reduction.normalisation)


def _check_motion(structure: Structure, q: Array, acts: Acting, mass: Array) -> None:
    """ValueError where small motions about q (n,), of mass (n, n), are no sum of real modes."""
    if not has_potential(structure, acts):
        raise ValueError(
            f"{structure.name}: under a load that follows, or a moment in space, there are no real modes"
        )
    if acts.turning is None:
        return
    beam = chain(structure)
    at = configuration(beam, q)
    unit_rates = velocities(beam, at, np.eye(beam.coordinates))
    coriolis = acts.generalised(beam, at, motion=unit_rates) - acts.generalised(beam, at)
    size = np.linalg.norm(acts.turning.velocity) * np.abs(mass).max()
    if np.abs(coriolis).max() > _ROUNDING * size:
        raise ValueError(
            f"{structure.name}: Coriolis forces of a turning clamp couple its motions: it has no real modes"
        )


def _signs(structure: Structure, q: Array, modes: Array) -> Array:
    """(n,) ±1 for each mode (n, n), from the rise of the tip, Jᵀ e_z, or the largest component."""
    beam = chain(structure)
    nothing = np.zeros((beam.elements, 3))
    upwards = generalised_forces(beam, configuration(beam, q), nothing, nothing, np.array([0.0, 0.0, 1.0]))
    rise = upwards @ modes
    largest = modes[np.argmax(np.abs(modes), axis=0), np.arange(modes.shape[1])]
    lifts = np.abs(rise) > 1e-6 * np.linalg.norm(modes, axis=0) * structure.length_m
    return np.sign(np.where(lifts, rise, largest))
