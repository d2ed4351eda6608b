"""An aerodynamics to first order in the modal coordinates and velocities, exact in everything else."""

import numpy as np

from flexsurr.aerodynamics.features import FIRST_ETA
from flexsurr.simulation.mapping import CompiledMapping
from flexsurr.simulation.rhs import Array

_STEP = 1e-3


def linear_in_modes(form: CompiledMapping, u: Array) -> Array:
    """Coefficients (m, 12) at features `u` (m, 25), linearised about the undeformed airframe at rest.

    c(r, 0) + ∂c/∂m m, with m the modal coordinates and velocities and r the other features. The derivative
    along m is a central difference, whose error is 1e-6 of the third order in m.
    """
    rigid, ahead, behind = (np.array(u) for _ in range(3))
    rigid[:, FIRST_ETA:] = 0.0
    ahead[:, FIRST_ETA:] *= _STEP
    behind[:, FIRST_ETA:] *= -_STEP
    return np.asarray(form(rigid) + (form(ahead) - form(behind)) / (2.0 * _STEP))
