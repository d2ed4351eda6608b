"""The planform of a lifting surface along its own length, for its lattice and for the beam within it."""

import numpy as np

from flexsurr.config.aircraft import Surface
from flexsurr.simulation.rhs import Array


class Planform:
    """The right (or only) half of a surface; lengths along it are measured from its root.

    `ends` (k + 1,) are the lengths [m] at which its k sections meet, root and tip included, `corners`
    (k + 1, 3) [m] its leading edge there, and `spans` (k + 1,) [m] its span coordinates: y, or height above
    the root where the surface is `vertical`.
    """

    def __init__(self, surface: Surface, vertical: bool = False) -> None:
        self.vertical = vertical
        sections = surface.sections
        lengths = np.array([section.length_m for section in sections])
        self.ends = np.concatenate([[0.0], np.cumsum(lengths)])
        dihedral = np.radians([section.dihedral_deg for section in sections]) + (
            0.5 * np.pi if vertical else 0.0
        )
        sweep = np.radians([section.sweep_deg for section in sections])
        # sweep is that of the leading edge against its own projection on the y-z plane
        steps = np.stack([np.tan(sweep), np.cos(dihedral), np.sin(dihedral)], axis=1) * lengths[:, None]
        self.corners = np.array(surface.root_m) + np.concatenate([np.zeros((1, 3)), np.cumsum(steps, axis=0)])
        self.spans = self.corners[:, 2] - self.corners[0, 2] if vertical else self.corners[:, 1]
        self._chords = np.array([sections[0].chord_m[0], *(section.chord_m[1] for section in sections)])

    def leading_edge(self, length: Array) -> Array:
        """Points (m, 3) [m] of the leading edge at lengths (m,)."""
        return np.stack([np.interp(length, self.ends, column) for column in self.corners.T], axis=-1)

    def chord(self, length: Array) -> Array:
        """Chord [m] at lengths (m,)."""
        chord: Array = np.interp(length, self.ends, self._chords)
        return chord
