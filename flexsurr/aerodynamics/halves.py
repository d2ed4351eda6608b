"""The frozen lattice of an airframe whose panels are their own mirror image, in two halves.

A flow is the sum of an even one, which the plane of symmetry mirrors into itself, and an odd one, which it
mirrors into its negative. Panels that are each other's image have equal circulations in the even flow and
opposite ones in the odd flow; a panel in the plane of symmetry, such as the fin's, takes part in the odd flow
alone. So matrices fall into two blocks of half the size, whatever the wash: controls, modes and sideslip need
no symmetry, the panels do.

A force is square to its bound vortex, so of the velocity there two components do. They and the circulation
are known for unit wash beforehand, and each number is read once.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from flexsurr.aerodynamics.airframe import Panels
from flexsurr.aerodynamics.boundary import normal_wash, onset
from flexsurr.aerodynamics.features import COEFFICIENTS, FEATURES, MACH
from flexsurr.aerodynamics.forces import add_body, add_vortex_force, name_coefficients
from flexsurr.aerodynamics.horseshoe import influence
from flexsurr.aerodynamics.lattice import Lattice
from flexsurr.aerodynamics.mach_grid import MachGrid, write_weights
from flexsurr.simulation.mapping import CompiledMapping, implements_mapping
from flexsurr.simulation.rhs import Array

# Of the largest coordinate: images apart by more than that are none.
_ROUNDING = 1e-12


class Halves(NamedTuple):
    """Places of the panels in a lattice: `right` (P,), `left` (P,) their images, `middle` (C,) the rest."""

    right: NDArray[np.intp]
    left: NDArray[np.intp]
    middle: NDArray[np.intp]


def halves_of(lattice: Lattice) -> Halves | None:
    """The halves of `lattice` on either side of the plane y = 0; None where a panel has no image.

    A panel in that plane is its own image with the opposite circulation, for the image of its bound vortex
    runs the other way.
    """
    image = lattice.mirrored()
    points = np.concatenate([lattice.start, lattice.end, lattice.control], axis=1)
    images = np.concatenate([image.start, image.end, image.control], axis=1)
    turned = np.concatenate([image.end, image.start, image.control], axis=1)
    size = float(np.abs(points).max())

    def same(first: Array, second: Array, of: float) -> NDArray[np.bool_]:
        return np.asarray(np.abs(first - second).max(axis=1) <= _ROUNDING * of)

    apart = np.zeros((len(lattice),) * 2)
    for here, there in zip(points.T, images.T, strict=True):
        np.maximum(apart, np.abs(here - there[:, None]), out=apart)
    partner = apart.argmin(axis=1)
    number = np.arange(len(lattice))
    own = same(points, turned, size) & same(lattice.normal, -image.normal, 1.0)
    paired = same(points[partner], images, size) & same(lattice.normal[partner], image.normal, 1.0)
    paired &= (partner != number) & (partner[partner] == number)
    if not np.all(own ^ paired):
        return None
    right = np.flatnonzero(paired & (number < partner))
    return Halves(right, partner[right], np.flatnonzero(own))


class FrozenHalves(NamedTuple):
    """Panels to the right, in the middle, and to the left: P, C and P of them, H = P + C.

    `across` (H, 2, 3): two unit vectors square to each bound vortex, of a wing upwards and aft. `even` (H, K,
    3, P) and `odd` (H, K, 3, H): for unit wash circulations [m] and the velocities along the two that they
    induce, at K Mach numbers.
    """

    panels: Panels
    exact: bool
    grid: MachGrid
    across: Array
    even: Array
    odd: Array


def frozen_in_halves(panels: Panels, halves: Halves, grid: MachGrid, exact: bool) -> CompiledMapping:
    """What `frozen_whole` gives for the same `panels`, to rounding."""
    order = np.concatenate([halves.right, halves.middle, halves.left])
    panels = _in_order(panels, order)
    pairs, half = len(halves.right), len(halves.right) + len(halves.middle)
    across = _across(panels.vortex[:half])
    even: list[Array] = []
    odd: list[Array] = []
    for node in grid.nodes:
        at_control = influence(panels.ends, 1.0 / node, panels.control[:half])
        normalwash = np.einsum("dij,id->ij", at_control, panels.normal[:half])
        at_bound = influence(panels.ends, 1.0 / node, panels.bound[:half])
        velocity = np.einsum("dij,ikd->kij", at_bound, across)
        for blocks, sign, size in ((even, 1.0, pairs), (odd, -1.0, half)):
            inverse = np.linalg.inv(_folded(normalwash, pairs, sign)[:size, :size])
            circulation = np.zeros((half, size))
            circulation[:size] = inverse
            induced = _folded(velocity, pairs, sign)[..., :size] @ inverse
            blocks.append(np.stack([circulation, *induced], axis=1))
    kernel = FrozenHalves(panels, exact, grid, across, np.stack(even, axis=1), np.stack(odd, axis=1))
    return CompiledMapping(kernel, len(grid.nodes) + pairs + half, FEATURES, COEFFICIENTS)


def _in_order(panels: Panels, order: NDArray[np.intp]) -> Panels:
    by_panel = panels._replace(ends=panels.ends.T)
    ordered = Panels._make(value[order] if isinstance(value, np.ndarray) else value for value in by_panel)
    return ordered._replace(ends=np.ascontiguousarray(ordered.ends.T))


def _across(vortex: Array) -> Array:
    """Two unit vectors (n, 2, 3) square to each of `vortex` (n, 3) and to each other."""
    along = vortex / np.linalg.norm(vortex, axis=1)[:, None]
    first = np.cross(np.array([1.0, 0.0, 0.0]), along)
    first /= np.linalg.norm(first, axis=1)[:, None]
    return np.stack([first, np.cross(along, first)], axis=1)


def _folded(matrix: Array, pairs: int, sign: float) -> Array:
    """Of (..., half, N) the columns (..., half, half) where images have `sign` times the circulation."""
    half = matrix.shape[-2]
    folded = matrix[..., :half].copy()
    folded[..., :pairs] += sign * matrix[..., half:]
    return folded


@implements_mapping(FrozenHalves)
def _frozen_halves(kernel, u, y, work):
    panels, exact, grid, across, even, odd = kernel
    half, count = even.shape[0], grid.nodes.size
    pairs = even.shape[3]
    # work: weights of the nodes, even and odd wash
    # unsigned: numba lets a signed index be negative, and a loop over such does not vectorise
    even_wash, even_columns = np.uint64(count), np.uint64(pairs)
    odd_wash, odd_columns = np.uint64(count + pairs), np.uint64(half)
    far = onset(exact, u)
    write_weights(grid, u[MACH], work)
    for k in range(y.size):
        y[k] = 0.0
    for i in range(half):
        wash = -normal_wash(exact, far, panels, u, i)
        if i < pairs:
            image = -normal_wash(exact, far, panels, u, half + i)
            work[count + i] = 0.5 * (wash + image)
            wash = 0.5 * (wash - image)
        work[count + pairs + i] = wash
    for i in range(half):
        # sums over the nodes, of the panel and of its image
        gamma, up, aft = 0.0, 0.0, 0.0
        gamma_image, up_image, aft_image = 0.0, 0.0, 0.0
        for node in range(count):
            weight = work[node]
            if weight == 0.0:
                continue
            even_gamma, even_up, even_aft = 0.0, 0.0, 0.0
            for j in range(even_columns):
                wash = work[even_wash + j]
                even_gamma += even[i, node, 0, j] * wash
                even_up += even[i, node, 1, j] * wash
                even_aft += even[i, node, 2, j] * wash
            odd_gamma, odd_up, odd_aft = 0.0, 0.0, 0.0
            for j in range(odd_columns):
                wash = work[odd_wash + j]
                odd_gamma += odd[i, node, 0, j] * wash
                odd_up += odd[i, node, 1, j] * wash
                odd_aft += odd[i, node, 2, j] * wash
            one = weight * (even_gamma + odd_gamma)
            gamma += one
            up += one * (even_up + odd_up)
            aft += one * (even_aft + odd_aft)
            one = weight * (even_gamma - odd_gamma)
            gamma_image += one
            up_image += one * (even_up - odd_up)
            aft_image += one * (even_aft - odd_aft)
        vx = up * across[i, 0, 0] + aft * across[i, 1, 0]
        vy = up * across[i, 0, 1] + aft * across[i, 1, 1]
        vz = up * across[i, 0, 2] + aft * across[i, 1, 2]
        add_vortex_force(far, panels, u, i, gamma, vx, vy, vz, y)
        if i < pairs:
            vx = up_image * across[i, 0, 0] + aft_image * across[i, 1, 0]
            vy = up_image * across[i, 0, 1] + aft_image * across[i, 1, 1]
            vz = up_image * across[i, 0, 2] + aft_image * across[i, 1, 2]
            add_vortex_force(far, panels, u, half + i, gamma_image, vx, -vy, vz, y)
    add_body(exact, panels, u, y)
    name_coefficients(u, y)
