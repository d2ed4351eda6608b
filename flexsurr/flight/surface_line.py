"""A lifting surface along its own length: leading edge, chord and the elastic axis its beam follows."""

import math

import numpy as np

from flexsurr.config.aircraft import Surface
from flexsurr.simulation.rhs import Array


class SurfaceLine:
    """The right (or only) half of a surface; lengths along it are measured from its root."""

    def __init__(self, surface: Surface, vertical: bool = False) -> None:
        self.vertical = vertical
        self._lengths = np.concatenate([[0.0], np.cumsum([s.length_m for s in surface.sections])])
        self._chords = np.array([surface.sections[0].chord_m[0], *(s.chord_m[1] for s in surface.sections)])
        corners = [np.array(surface.root_m)]
        for section in surface.sections:
            dihedral = math.radians(section.dihedral_deg) + (0.5 * math.pi if vertical else 0.0)
            sweep = math.tan(math.radians(section.sweep_deg))
            direction = np.array([sweep, math.cos(dihedral), math.sin(dihedral)])
            corners.append(corners[-1] + section.length_m * direction)
        self._corners = np.array(corners)
        self._spans = self._corners[:, 2] - self._corners[0, 2] if vertical else self._corners[:, 1]
        self.start = self.length_at(surface.beam_starts_at_m)
        self.end = float(self._lengths[-1])
        axis = surface.elastic_axis
        stations = [self.start, *(length for length in self._lengths if length > self.start + 1e-9)]
        self._axis_lengths = np.array(stations)
        self._axis = np.array(axis if len(axis) > 1 else axis * len(stations))

    @property
    def breaks(self) -> Array:
        """Lengths at which sections meet, root and tip included."""
        return self._lengths

    def length_at(self, span: float) -> float:
        """Length at the span coordinate [m]: y, or height above the root of a vertical surface."""
        return float(np.interp(span, self._spans, self._lengths))

    def span_at(self, points: Array) -> Array:
        """Span coordinate (m,) [m] of `points` (m, 3), those of a left half by their distance."""
        return points[:, 2] - self._corners[0, 2] if self.vertical else np.abs(points[:, 1])

    def chord(self, length: Array) -> Array:
        """Chord [m] at lengths (m,)."""
        return np.interp(length, self._lengths, self._chords)

    def at_chord_fraction(self, length: Array, fraction: Array | float) -> Array:
        """Points (m, 3) behind the leading edge by a fraction of the chord, along x."""
        leading = np.stack([np.interp(length, self._lengths, column) for column in self._corners.T], axis=-1)
        leading[..., 0] += fraction * self.chord(length)
        return leading

    def elastic_axis(self, length: Array) -> Array:
        """Points (m, 3) of the elastic axis; inboard of the beam it keeps its first fraction of the chord."""
        return self.at_chord_fraction(length, np.interp(length, self._axis_lengths, self._axis))
