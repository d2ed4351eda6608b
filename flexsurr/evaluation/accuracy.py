"""How far a trajectory strays from the tight solution of the reference it stands for."""

from dataclasses import dataclass

import numpy as np

from flexsurr.evaluation.cases import ReferenceSolution
from flexsurr.simulation.rhs import Array

SHORT_S = 2.0
"""Errors are also given over the first seconds, before the phase error of hundreds of periods."""


@dataclass(frozen=True)
class TipError:
    """Largest errors of the tip's motion in percent of the reference's largest, and the phase lag [s].

    `phase_lag_s` is positive where the model is late; NaN where the numbers of oscillations differ.
    """

    whole_percent: float
    short_percent: float
    phase_lag_s: float


def tip_error_percent(reference: ReferenceSolution, motion: Array) -> Array:
    """‖motion − reference's motion‖ over the reference's largest displacement from rest, in percent, (k,).

    `motion` (k, 3) [m] in the clamp's frame or (k, 1) [rad], as `cases.tip_motion` has it, holds the first
    k ≤ m of the reference's sample times.
    """
    distance = np.linalg.norm(motion - reference.motion[: motion.shape[0]], axis=1)
    return np.asarray(100.0 * distance / reference.peak)


def tip_error(reference: ReferenceSolution, motion: Array) -> TipError:
    """The largest errors of `motion` (as above) over the whole response and over its first `SHORT_S`."""
    error = tip_error_percent(reference, motion)
    short = reference.t[: error.size] <= reference.t[0] + SHORT_S
    return TipError(
        whole_percent=float(error.max()),
        short_percent=float(error[short].max()),
        phase_lag_s=phase_lag(reference.t[: error.size], motion[:, -1], reference.motion[: error.size, -1]),
    )


def phase_lag(t: Array, z: Array, z_reference: Array) -> float:
    """Delay [s] of the last upward zero crossing of `z` (k,) behind that of `z_reference` (k,).

    NaN where either never crosses, or where the two do not count the same number of crossings.
    """
    ours, theirs = _upward_crossings(t, z), _upward_crossings(t, z_reference)
    if ours.size == 0 or ours.size != theirs.size:
        return float("nan")
    return float(ours[-1] - theirs[-1])


def _upward_crossings(t: Array, z: Array) -> Array:
    """Times at which the straight lines between samples cross zero from below."""
    i = np.flatnonzero((z[:-1] < 0.0) & (z[1:] >= 0.0))
    return np.asarray(t[i] - z[i] * (t[i + 1] - t[i]) / (z[i + 1] - z[i]))
