"""Properties along the span: their values anywhere, and their integrals over parts of it."""

from collections.abc import Callable

import numpy as np

from flexsurr.config.along_span import AXIS_KEYS
from flexsurr.config.structure import Structure
from flexsurr.simulation.rhs import Array

# Gauss's rule on each piece between stations and ends of elements: exact for degree 11. The integrands are
# polynomials, inverses of linear functions, and sines of angles that turn little within an element.
_POINTS, _WEIGHTS = np.polynomial.legendre.leggauss(6)


def property_at(structure: Structure, key: str, s: Array) -> Array:
    """The property `key` at the lengths `s` (k,) along the axis [m]; zero where the structure has none.

    At a jump, or a station of a piecewise constant table, it is the value further out.
    """
    values = structure.values_of(key) if key in type(structure).model_fields else (0.0,)
    table = structure.along_span
    if table is not None and getattr(table, key) is not None:
        values = getattr(table, key)
    if table is None or len(values) == 1:
        return np.full(len(s), 0.0 if values[0] is None else float(values[0]))
    stations, column = np.array(table.stations_m), np.array(values)
    after = np.clip(np.searchsorted(stations, s, side="right"), 1, len(stations) - 1)
    before = after - 1
    if table.interpolation == "constant":
        return column[before]
    width = stations[after] - stations[before]
    # a jump at the very tip has no width
    share = np.where(width > 0.0, (s - stations[before]) / np.where(width > 0.0, width, 1.0), 1.0)
    return np.asarray(column[before] + share * (column[after] - column[before]))


def integral(structure: Structure, of: Callable[[Array], Array], ends: Array) -> Array:
    """(k, …) ∫ of(s) ds from each of `ends` (k + 1,) [m] to the next; `of` takes s (m,), gives (m, …)."""
    stations = () if structure.along_span is None else structure.along_span.stations_m
    cuts = np.unique(np.concatenate([ends, np.clip(stations, ends[0], ends[-1])]))
    half = 0.5 * np.diff(cuts)
    points = (cuts[:-1] + half)[:, None] + half[:, None] * _POINTS
    values = np.asarray(of(points.ravel()))
    weights = (half[:, None] * _WEIGHTS).ravel()
    weighted = values * weights.reshape(-1, *[1] * (values.ndim - 1))
    pieces = weighted.reshape(len(half), len(_POINTS), *values.shape[1:]).sum(axis=1)
    return np.asarray(np.add.reduceat(pieces, np.searchsorted(cuts, ends[:-1]), axis=0))


def section_axes(structure: Structure, s: Array) -> Array:
    """(k, 3, 3) axes of the unloaded sections at `s` (k,) [m], in those of the clamp; columns are x, y, z.

    ψ about z, θ about −y (so that positive θ lifts x), φ about x, as the clamp's own.
    """
    psi, theta, phi = (np.deg2rad(property_at(structure, key, s)) for key in AXIS_KEYS)
    cz, sz, cy, sy = np.cos(psi), np.sin(psi), np.cos(theta), np.sin(theta)
    cx, sx = np.cos(phi), np.sin(phi)
    x = np.stack([cz * cy, sz * cy, sy], axis=-1)
    y = np.stack([-sz * cx - cz * sy * sx, cz * cx - sz * sy * sx, cy * sx], axis=-1)
    z = np.stack([sz * sx - cz * sy * cx, -cz * sx - sz * sy * cx, cy * cx], axis=-1)
    return np.stack([x, y, z], axis=-1)


def axis_at(structure: Structure, s: Array) -> Array:
    """(k, 3) points of the unloaded elastic axis at `s` (k,), ascending, in the clamp's axes [m]."""
    ends = np.concatenate([[0.0], s])
    steps = np.zeros((len(s), 3))
    moved = np.diff(ends) > 0.0
    if moved.any():
        distinct = np.unique(ends)
        steps[moved] = integral(structure, lambda at: section_axes(structure, at)[:, :, 0], distinct)
    beside = property_at(structure, "elastic_axis_offset_m", s)
    line = np.cumsum(steps, axis=0)
    return np.asarray(line + beside[:, None] * section_axes(structure, s)[:, :, 1])
