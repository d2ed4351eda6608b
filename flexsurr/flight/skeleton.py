"""A skeleton: nodes, beam elements between them and masses attached to them, with its matrices.

Elements are those of Euler and Bernoulli between two nodes of six degrees of freedom: displacement (3) and
small rotation (3). The local x axis leads from the first end to the second; flapwise bending moves an element
along its local z, edgewise along its local y. Source: J. S. Przemieniecki, *Theory of Matrix Structural
Analysis*, McGraw-Hill 1968, section 5.6, without shear.
"""

from dataclasses import dataclass

import numpy as np

from flexsurr.simulation.rhs import Array

Section = tuple[float, float, float, float]
"""EA [N], EI flapwise, EI edgewise and GJ [N m²]."""


@dataclass(frozen=True, eq=False)
class BeamElement:
    """An element between two ends, each carried by a node through a rigid arm (which may be nothing).

    `nodes` are places in the list of nodes; `ends` (2, 3) [m]; `normal` is any vector that lies in the
    plane of local x and z.
    """

    nodes: tuple[int, int]
    ends: Array
    section: Section
    normal: tuple[float, float, float]


def skew(r: Array) -> Array:
    """The matrix (3, 3) whose product with a vector is r × that vector."""
    x, y, z = r
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])


def local_stiffness(length: float, section: Section) -> Array:
    """Stiffness matrix (12, 12) of an element of `length` [m] in its own axes."""
    ea, flapwise, edgewise, gj = section
    matrix = np.zeros((12, 12))
    for dof, stiffness in ((0, ea / length), (3, gj / length)):
        matrix[np.ix_([dof, dof + 6], [dof, dof + 6])] = stiffness * np.array([[1.0, -1.0], [-1.0, 1.0]])
    # a positive rotation about y lowers the far end, one about z moves it to +y
    for ei, deflection, rotation, sign in ((flapwise, 2, 4, -1.0), (edgewise, 1, 5, 1.0)):
        a = 6.0 * length * sign
        b = 2.0 * length**2
        block = np.array(
            [[12.0, a, -12.0, a], [a, 2.0 * b, -a, b], [-12.0, -a, 12.0, -a], [a, b, -a, 2.0 * b]]
        )
        dofs = [deflection, rotation, deflection + 6, rotation + 6]
        matrix[np.ix_(dofs, dofs)] = ei / length**3 * block
    return matrix


def element_axes(element: BeamElement) -> Array:
    """Local axes as rows (3, 3). Raises ValueError where the normal lies along the element."""
    along = element.ends[1] - element.ends[0]
    x = along / np.linalg.norm(along)
    normal = np.asarray(element.normal, dtype=np.float64)
    z = normal - (normal @ x) * x
    if np.linalg.norm(z) < 1e-6 * np.linalg.norm(normal):
        raise ValueError(f"the normal {element.normal} lies along the element")
    z /= np.linalg.norm(z)
    return np.array([x, np.cross(z, x), z])


def element_stiffness(element: BeamElement, nodes: Array) -> Array:
    """Stiffness matrix (12, 12) for the motion of the element's two nodes, in the axes of `nodes` (n, 3)."""
    length = float(np.linalg.norm(element.ends[1] - element.ends[0]))
    transformation = np.zeros((12, 12))
    axes = element_axes(element)
    for end in range(2):
        arm = element.ends[end] - nodes[element.nodes[end]]
        rows = slice(6 * end, 6 * end + 6)
        # displacement at the end = that of the node + rotation × arm
        transformation[rows, rows] = np.kron(np.eye(2), axes) @ np.block(
            [[np.eye(3), -skew(arm)], [np.zeros((3, 3)), np.eye(3)]]
        )
    return transformation.T @ local_stiffness(length, element.section) @ transformation


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
