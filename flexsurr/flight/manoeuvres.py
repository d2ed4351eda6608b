"""Doublets of elevator, aileron and rudder, and the flights that follow from them."""

import numpy as np

from flexsurr.config.flight import Control, DoubletTimes
from flexsurr.config.study import Integrator
from flexsurr.flight.model import Doublet
from flexsurr.flight.trim import Trim
from flexsurr.simulation import Trajectory, simulate

# Signs on (i_t, elevator left, right, aileron left, right, rudder); positive aileron rolls to the right.
COMMANDS: dict[Control, tuple[float, ...]] = {
    "elevator": (0.0, 1.0, 1.0, 0.0, 0.0, 0.0),
    "aileron": (0.0, 0.0, 0.0, 1.0, -1.0, 0.0),
    "rudder": (0.0, 0.0, 0.0, 0.0, 0.0, 1.0),
}


def doublet(control: Control, amplitude_rad: float, times: DoubletTimes | None = None) -> Doublet:
    """A doublet of one control: + amplitude, − amplitude, back."""
    times = times or DoubletTimes()
    command = amplitude_rad * np.array(COMMANDS[control])
    return Doublet(command, (times.start_s, times.middle_s, times.end_s))


def fly(trim: Trim, pilot: Doublet | None, duration_s: float = 5.0, step_s: float = 0.005) -> Trajectory:
    """`duration_s` of flight from `trim` with a pilot's input, by RK4 with one sample a step."""
    steps = round(duration_s / step_s)
    t = np.linspace(0.0, duration_s, steps + 1)
    return simulate(trim.model.with_doublet(pilot), t, trim.state, Integrator(method="rk4", step_s=step_s))
