"""The elastic axis of a lifting surface, along its own length."""

import numpy as np

from flexsurr.aerodynamics.planform import Planform
from flexsurr.config.aircraft import Surface
from flexsurr.simulation.rhs import Array


class SurfaceLine(Planform):
    """A planform with the elastic axis that its beam follows."""

    def __init__(self, surface: Surface, vertical: bool = False) -> None:
        super().__init__(surface, vertical)
        self.start = self.length_at(surface.beam_starts_at_m)
        self.end = float(self.ends[-1])
        axis = surface.elastic_axis
        stations = [self.start, *(length for length in self.ends if length > self.start + 1e-9)]
        self._axis_lengths = np.array(stations)
        self._axis = np.array(axis if len(axis) > 1 else axis * len(stations))

    def length_at(self, span: float) -> float:
        """Length at the span coordinate [m]: y, or height above the root of a vertical surface."""
        return float(np.interp(span, self.spans, self.ends))

    def span_at(self, points: Array) -> Array:
        """Span coordinate (m,) [m] of `points` (m, 3), those of a left half by their distance."""
        return points[:, 2] - self.corners[0, 2] if self.vertical else np.abs(points[:, 1])

    def at_chord_fraction(self, length: Array, fraction: Array | float) -> Array:
        """Points (m, 3) behind the leading edge by a fraction of the chord, along x."""
        leading = self.leading_edge(length)
        leading[..., 0] += fraction * self.chord(length)
        return leading

    def elastic_axis(self, length: Array) -> Array:
        """Points (m, 3) of the elastic axis; inboard of the beam it keeps its first fraction of the chord."""
        return self.at_chord_fraction(length, np.interp(length, self._axis_lengths, self._axis))
