"""What an elastic mode is: which part of the aircraft carries its kinetic energy, and which way it goes."""

from dataclasses import dataclass

import numpy as np

from flexsurr.flight.modes import FreeModes
from flexsurr.simulation.rhs import Array

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
