"""The exact quadratic form: where the boundary condition is linear, so are circulations and velocities.

With ξ = (1, all features but Mach number and altitude), every sum in body axes is ξᵀ Q(M) ξ; Q is worked out
on a grid of Mach numbers. Altitude acts through the parasite drag, which is added. Lift and drag follow by
the sine and cosine of α, which no quadratic form holds.
"""

from typing import NamedTuple

import numpy as np

from flexsurr.aerodynamics.airframe import Airframe, Panels, panels_of
from flexsurr.aerodynamics.features import (
    ALPHA,
    BETA,
    COEFFICIENTS,
    FEATURES,
    FIRST_CONTROL,
    FIRST_ETA,
    FIRST_ETA_RATE,
    MACH,
    RATE_P,
)
from flexsurr.aerodynamics.forces import add_body, name_coefficients
from flexsurr.aerodynamics.mach_grid import MachGrid, write_weights
from flexsurr.aerodynamics.vortex_lattice import frozen_matrices
from flexsurr.simulation.mapping import CompiledMapping, implements_mapping
from flexsurr.simulation.rhs import Array

TERMS = len(FEATURES) - 1  # the constant in place of Mach number and altitude


class Quadratic(NamedTuple):
    """`forms` (K, 12, P): coefficients of the P products ξ_a ξ_b, a ≤ b, at each node; row by row of a."""

    panels: Panels
    grid: MachGrid
    forms: Array


def quadratic(airframe: Airframe, grid: MachGrid) -> CompiledMapping:
    """What `frozen` gives with a linear boundary condition on the same `grid`, to rounding."""
    panels = panels_of(airframe)
    kernel = Quadratic(panels, grid, quadratic_forms(panels, grid))
    work_size = len(grid.nodes) + TERMS + kernel.forms.shape[2]
    return CompiledMapping(kernel, work_size, FEATURES, COEFFICIENTS)


def quadratic_forms(panels: Panels, grid: MachGrid) -> Array:
    """Coefficients (K, 12, P) of the products, in body axes."""
    wash = _wash_of_terms(panels)
    onset = _onset_of_terms(panels.bound, panels.bound_shift)
    matrices = frozen_matrices(panels, grid)
    upper = np.triu_indices(TERMS)
    forms = []
    for inverse, induced in zip(matrices.inverse, matrices.induced, strict=True):
        gamma = -inverse @ wash
        velocity = onset + np.einsum("dij,jb->idb", induced, gamma)
        force = np.cross(velocity, panels.vortex[:, :, None], axis=1) * (2.0 / panels.area)
        form = np.einsum("ia,idb,kid->kab", gamma, force, _readout(panels), optimize=True)
        symmetric = form + form.transpose(0, 2, 1)
        symmetric[:, range(TERMS), range(TERMS)] *= 0.5
        forms.append(symmetric[:, upper[0], upper[1]])
    return np.ascontiguousarray(np.stack(forms))


def _wash_of_terms(panels: Panels) -> Array:
    """Normal wash (N, TERMS) for a unit of each term, over V."""
    onset = _onset_of_terms(panels.control, panels.shift)
    wash: Array = np.einsum("idb,id->ib", onset, panels.normal)
    # what turning a normal changes along x, through which the undisturbed air comes
    wash[:, _term(FIRST_CONTROL) : _term(FIRST_ETA)] += np.cross(panels.hinge, panels.normal[:, None])[..., 0]
    wash[:, _term(FIRST_ETA) : _term(FIRST_ETA_RATE)] += np.cross(panels.turn, panels.normal[:, None])[..., 0]
    return wash


def _onset_of_terms(points: Array, shift: Array) -> Array:
    """The air's velocity (N, 3, TERMS) over V against moving points for a unit of each term."""
    onset = np.zeros((len(points), 3, TERMS))
    onset[:, 0, 0] = 1.0
    onset[:, 2, _term(ALPHA)] = 1.0
    onset[:, 1, _term(BETA)] = -1.0
    # body rates (p, q, r) are (−p, q, −r) in geometry axes
    for axis, sign in enumerate((-1.0, 1.0, -1.0)):
        onset[:, :, _term(RATE_P) + axis] = -np.cross(sign * np.eye(3)[axis], points)
    onset[:, :, _term(FIRST_ETA_RATE) :] = -shift.transpose(0, 2, 1)
    return onset


def _readout(panels: Panels) -> Array:
    """What each sum in body axes reads (12, N, 3) from the forces on the bound vortices."""
    signs = np.array([-1.0, 1.0, -1.0])  # in body axes
    forces = np.eye(3)[:, None, :] * signs[:, None, None] * np.ones((1, len(panels.bound), 1))
    # r × F along e is F · (e × r)
    lengths = np.array([panels.span, panels.chord, panels.span])
    moments = np.cross(np.eye(3)[:, None, :], panels.bound) * (signs / lengths)[:, None, None]
    return np.concatenate([forces, moments, panels.bound_shift.transpose(1, 0, 2)])


def _term(feature: int) -> int:
    """Place of a feature among the terms."""
    return feature - 1


@implements_mapping(Quadratic)
def _quadratic(kernel, u, y, work):
    panels, grid, forms = kernel
    count = grid.nodes.size
    # work: weights of the nodes, terms, their products
    terms, products = count, count + TERMS
    write_weights(grid, u[MACH], work)
    work[terms] = 1.0
    for a in range(1, TERMS):
        work[terms + a] = u[a + 1]
    place = products
    for a in range(TERMS):
        for b in range(a, TERMS):
            work[place] = work[terms + a] * work[terms + b]
            place += 1
    first = np.uint64(products)  # unsigned, so that the loop over products vectorises
    for k in range(y.size):
        y[k] = 0.0
    for node in range(count):
        weight = work[node]
        if weight == 0.0:
            continue
        for k in range(y.size):
            total = 0.0
            for m in range(np.uint64(forms.shape[2])):
                total += forms[node, k, m] * work[first + m]
            y[k] += weight * total
    add_body(False, panels, u, y)
    name_coefficients(u, y)
