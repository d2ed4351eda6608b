"""Static equilibrium of the chain under gravity and constant loads (eq. 8)."""

import numpy as np

from flexsurr.beam.chain import chain, check_coordinates
from flexsurr.beam.kinematics import configuration, generalised_forces
from flexsurr.beam.loads import Load, static_forces
from flexsurr.config.structure import Structure
from flexsurr.simulation.rhs import Array

_STEP = 1e-30  # complex step: no cancellation, so as small as one likes
_ITERATIONS = 30
_SMALLEST_LOAD_STEP = 1.0 / 1024.0
_TOLERANCE = 1e-11  # residual over the size of springs' and loads' moments


class EquilibriumNotFound(ArithmeticError):
    """No static equilibrium was reached; the message names structure, load and residual."""


def find_equilibrium(structure: Structure, load: Load | None = None) -> Array:
    """The q (n,) with K q = Q(q) under gravity and `load` (a constant one), eq. 8.

    Newton's method from the undeformed shape with the exact tangent; where it does not converge, the load
    is applied in steps. Raises EquilibriumNotFound, and ValueError for a load that changes with time.
    """
    q = np.zeros(structure.coordinates)
    reached, step = 0.0, 1.0
    while reached < 1.0:
        fraction = min(1.0, reached + step)
        candidate, residual = _newton(structure, load, fraction, q)
        if residual <= _TOLERANCE:  # False for NaN as well
            q, reached, step = candidate, fraction, 2.0 * step
        else:
            step *= 0.5
            if step < _SMALLEST_LOAD_STEP:
                raise EquilibriumNotFound(
                    f"{structure.name}: no static equilibrium beyond {100.0 * reached:.1f} % of "
                    f"{load if load is not None else 'gravity'}; relative residual {residual:.1e}"
                )
    return q


def static_residual(structure: Structure, q: Array, load: Load | None = None, fraction: float = 1.0) -> Array:
    """K q − Q(q) (..., n) at q (..., n), with gravity and `load` scaled by `fraction`."""
    beam = chain(structure)
    return beam.stiffness * q - fraction * _forces(structure, q, load)


def tangent_stiffness(
    structure: Structure, q: Array, load: Load | None = None, fraction: float = 1.0
) -> Array:
    """(n, n) K − ∂Q/∂q at q (n,): springs and geometric stiffness, all columns by complex steps at once."""
    check_coordinates(structure, q)
    steps = q + 1j * _STEP * np.eye(structure.coordinates)
    columns = static_residual(structure, steps, load, fraction).imag / _STEP
    # Forces that have a potential give a symmetric tangent; averaging removes the rounding.
    return 0.5 * (columns + columns.T)


def _forces(structure: Structure, q: Array, load: Load | None) -> Array:
    beam = chain(structure)
    on_centres, on_tip, _ = static_forces(structure, load)  # no couple is constant
    weights = np.tile(beam.element_mass * beam.gravity, (beam.elements, 1))
    return generalised_forces(beam, configuration(beam, q), weights, on_centres, on_tip)


def _size(structure: Structure, load: Load | None) -> float:
    """Gravity and `load` as a moment over the length [N m]."""
    beam = chain(structure)
    on_centres, on_tip, _ = static_forces(structure, load)
    weight = beam.elements * beam.element_mass * np.linalg.norm(beam.gravity)
    forces = weight + np.sum(np.linalg.norm(on_centres, axis=1)) + np.linalg.norm(on_tip)
    return float(forces) * structure.length_m


def _newton(structure: Structure, load: Load | None, fraction: float, q: Array) -> tuple[Array, float]:
    """(q, relative residual) after Newton's iteration, stopped once the residual is at rounding."""
    stiffness = chain(structure).stiffness
    applied = fraction * _size(structure, load)
    previous = np.inf
    for _ in range(_ITERATIONS):
        residual = static_residual(structure, q, load, fraction)
        scale = float(np.linalg.norm(stiffness * q)) + applied
        relative = float(np.linalg.norm(residual)) / scale if scale > 0.0 else 0.0
        if relative == 0.0 or not np.isfinite(relative) or (relative <= _TOLERANCE and relative >= previous):
            break
        previous = relative
        try:
            q = q - np.linalg.solve(tangent_stiffness(structure, q, load, fraction), residual)
        except np.linalg.LinAlgError:
            return q, np.inf
    return q, relative
