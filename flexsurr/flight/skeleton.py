"""A skeleton: nodes, beam elements between them and masses attached to them, with its matrices."""

from dataclasses import dataclass

import numpy as np

from flexsurr.flight.beam_element import BeamElement, element_stiffness, skew
from flexsurr.simulation.rhs import Array


@dataclass(frozen=True, eq=False)
class LumpedMass:
    """A rigid body of `mass` [kg] on a node; `inertia` (3, 3) [kg m²] about its centre `position` (3,)."""

    node: int
    position: Array
    mass: float
    inertia: Array
    part: str


@dataclass(frozen=True, eq=False)
class Skeleton:
    """Nodes (n, 3) [m], elements and masses, in one set of axes."""

    nodes: Array
    elements: tuple[BeamElement, ...]
    masses: tuple[LumpedMass, ...]

    def stiffness_matrix(self) -> Array:
        """K (6n, 6n): displacement [m] and rotation [rad] of each node in turn."""
        matrix = np.zeros((self.nodes.size * 2, self.nodes.size * 2))
        for element in self.elements:
            dofs = np.concatenate([np.arange(6 * node, 6 * node + 6) for node in element.nodes])
            matrix[np.ix_(dofs, dofs)] += element_stiffness(element, self.nodes)
        return matrix

    def mass_matrix(self) -> Array:
        """M (6n, 6n), a block for each node; zero where a node carries nothing."""
        matrix = np.zeros((self.nodes.size * 2, self.nodes.size * 2))
        for lump in self.masses:
            arm = skew(lump.position - self.nodes[lump.node])
            dofs = slice(6 * lump.node, 6 * lump.node + 6)
            matrix[dofs, dofs] += np.block(
                [
                    [lump.mass * np.eye(3), -lump.mass * arm],
                    [lump.mass * arm, lump.inertia - lump.mass * arm @ arm],
                ]
            )
        return matrix

    def rigid_body_motions(self, about: Array) -> Array:
        """Motion (6n, 6) of the nodes for unit translations and unit rotations about a point (3,)."""
        motions = np.zeros((len(self.nodes), 6, 6))
        for node, position in enumerate(self.nodes):
            motions[node] = np.block([[np.eye(3), -skew(position - about)], [np.zeros((3, 3)), np.eye(3)]])
        return motions.reshape(-1, 6)


@dataclass(frozen=True, eq=False)
class MassProperties:
    """Total mass [kg], centre of gravity (3,) [m] and inertia (3, 3) [kg m²] about it."""

    mass: float
    centre_of_gravity: Array
    inertia: Array


def mass_properties(skeleton: Skeleton) -> MassProperties:
    """Of all masses of `skeleton`, in its axes."""
    mass = sum(lump.mass for lump in skeleton.masses)
    centre = sum((lump.mass * lump.position for lump in skeleton.masses), np.zeros(3)) / mass
    inertia = np.zeros((3, 3))
    for lump in skeleton.masses:
        arm = skew(lump.position - centre)
        inertia += lump.inertia - lump.mass * arm @ arm
    return MassProperties(mass, centre, inertia)
