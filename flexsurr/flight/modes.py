"""Free-free modes of a stick model: natural frequencies, mass-normalised shapes in mean axes, and names.

A mode is named after the part of the aircraft that carries most of its kinetic energy, and the way it goes.
"""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import eigh

from flexsurr.flight.skeleton import MassProperties, mass_properties
from flexsurr.flight.stick_model import RIGHT, StickModel
from flexsurr.simulation.rhs import Array

RIGID = 6
_SHIFT = 200.0  # rad²/s², about the lowest elastic mode's
# A shape is called symmetric where its image in the plane of symmetry is itself to within this.
_SYMMETRIC = 0.5
_MOVES = 1e-3


@dataclass(frozen=True, eq=False)
class FreeModes:
    """Elastic modes of a free aircraft, in geometry axes.

    `shapes` (6n, k) are mass-normalised (modal mass 1 kg, amplitudes η in kg^½ m) and move neither the
    centre of gravity nor the principal axes: mean axes. The right wing's tip rises in each; where it hardly
    moves, the largest component is positive. `symmetric` (k,): about the plane y = 0. `rigid_body_rad_s`
    (6,) are the frequencies found for the rigid-body motions, zero but for rounding.
    """

    model: StickModel
    properties: MassProperties
    omega_rad_s: Array
    shapes: Array
    symmetric: tuple[bool, ...]
    rigid_body_rad_s: Array

    @property
    def frequency_hz(self) -> Array:
        """(k,) natural frequencies [Hz]."""
        return self.omega_rad_s / (2.0 * np.pi)


def free_modes(model: StickModel, count: int = 8) -> FreeModes:
    """The first `count` elastic modes of `model`. Raises ValueError for more than it has."""
    skeleton = model.skeleton
    stiffness, mass = skeleton.stiffness_matrix(), skeleton.mass_matrix()
    most = int(np.count_nonzero(np.diag(mass))) - RIGID
    if not 0 < count <= most:
        raise ValueError(f"count: {count} modes asked; allowed: 1 to {most}")
    # M φ = μ (K + s M) φ with μ = 1 / (ω² + s): regular although K leaves rigid-body motions free and some
    # nodes have no mass, and accurate to rounding where ω² is small.
    inverses, vectors = eigh(mass, stiffness + _SHIFT * mass)
    wanted = slice(-1, -RIGID - count - 1, -1)
    squares = 1.0 / inverses[wanted] - _SHIFT
    shapes = vectors[:, wanted][:, RIGID:]
    properties = mass_properties(skeleton)
    shapes = _in_mean_axes(shapes, mass, skeleton.rigid_body_motions(properties.centre_of_gravity))
    images = mirrored(skeleton.nodes, shapes)
    symmetric = tuple(bool(c > _SYMMETRIC) for c in np.einsum("ik,ij,jk->k", shapes, mass, images))
    return FreeModes(
        model=model,
        properties=properties,
        omega_rad_s=np.sqrt(squares[RIGID:]),
        shapes=np.ascontiguousarray(shapes * _signs(model, shapes)),
        symmetric=symmetric,
        rigid_body_rad_s=np.sqrt(np.abs(squares[:RIGID])),
    )


def _in_mean_axes(shapes: Array, mass: Array, rigid: Array) -> Array:
    """Remove what rounding leaves of rigid-body motion, and normalise."""
    momenta = rigid.T @ mass
    shapes = shapes - rigid @ np.linalg.solve(momenta @ rigid, momenta @ shapes)
    normalised: Array = shapes / np.sqrt(np.einsum("ik,ij,jk->k", shapes, mass, shapes))
    return normalised


def _signs(model: StickModel, shapes: Array) -> Array:
    tip = model.lines["wing", RIGHT][-1].nodes[1]
    rise = shapes[6 * tip + 2]
    largest = shapes[np.argmax(np.abs(shapes), axis=0), np.arange(shapes.shape[1])]
    signs: Array = np.sign(np.where(np.abs(rise) > _MOVES * np.abs(largest), rise, largest))
    return signs


def mirrored(nodes: Array, shapes: Array) -> Array:
    """The image of `shapes` (6n, k) in the plane y = 0, for `nodes` (n, 3) symmetric about it."""
    image = np.array([1.0, -1.0, 1.0])
    partner = [int(np.argmin(np.linalg.norm(nodes - node * image, axis=1))) for node in nodes]
    # a rotation is an axial vector: those about x and z change sign, that about y does not
    signs = np.concatenate([image, -image])
    found: Array = (shapes.reshape(len(nodes), 6, -1)[partner] * signs[:, None]).reshape(shapes.shape)
    return found


# Parts of the mass distribution that move together.
_PARTS = {
    "wing structure": "wing",
    "fuel": "wing",
    "engine": "engines",
    "horizontal tail": "horizontal tail",
    "vertical tail": "vertical tail",
}
_FUSELAGE = "fuselage"  # with all that it carries
_WORDS = {
    ("wing", "z"): "wing bending",
    ("wing", "x"): "wing in-plane bending",
    ("wing", "turn"): "wing torsion",
    ("engines", "z"): "engine nodding",
    ("engines", "y"): "engine sway",
    ("engines", "turn"): "engine rotation",
    (_FUSELAGE, "z"): "vertical fuselage bending",
    (_FUSELAGE, "y"): "lateral fuselage bending",
    (_FUSELAGE, "turn"): "fuselage torsion",
    ("horizontal tail", "z"): "horizontal tail bending",
    ("vertical tail", "y"): "vertical tail bending",
}


@dataclass(frozen=True)
class Motion:
    """A part of the aircraft in a mode: what it does, and its `share` of the mode's kinetic energy."""

    name: str
    share: float


def motions(modes: FreeModes) -> list[list[Motion]]:
    """For each mode its motions, the largest share first; shares add up to one."""
    shares = _energy_shares(modes)
    ranked = []
    for k in range(len(modes.omega_rad_s)):
        order = sorted(shares, key=lambda part: -shares[part][k])
        ranked.append([Motion(_WORDS.get(part, " ".join(part)), float(shares[part][k])) for part in order])
    return ranked


def mode_names(modes: FreeModes) -> list[str]:
    """For each mode its symmetry and what most of its kinetic energy is in."""
    return [
        f"{'symmetric' if symmetric else 'antisymmetric'} {ranked[0].name}"
        for symmetric, ranked in zip(modes.symmetric, motions(modes), strict=True)
    ]


def _energy_shares(modes: FreeModes) -> dict[tuple[str, str], Array]:
    """Share (k,) of the kinetic energy of each mode by part and direction: x, y, z, or turn."""
    skeleton = modes.model.skeleton
    shapes = modes.shapes.reshape(len(skeleton.nodes), 6, -1)
    shares: dict[tuple[str, str], Array] = {}
    for lump in skeleton.masses:
        shift, turn = shapes[lump.node, :3], shapes[lump.node, 3:]
        velocity = shift + np.cross(turn, (lump.position - skeleton.nodes[lump.node])[:, None], axis=0)
        part = _PARTS.get(lump.part, _FUSELAGE)
        energies = {axis: lump.mass * v**2 for axis, v in zip("xyz", velocity, strict=True)}
        energies["turn"] = np.einsum("ik,ij,jk->k", turn, lump.inertia, turn)
        for direction, energy in energies.items():
            shares[part, direction] = shares.get((part, direction), 0.0) + energy
    return shares
