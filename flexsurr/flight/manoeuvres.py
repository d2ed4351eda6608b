"""Doublets of elevator, aileron and rudder, and the flights that follow from them.

`fly` is compiled; `fly_stepped` takes its coefficients from any function of Python, such as a network in its
own framework.
"""

from collections.abc import Callable

import numpy as np

from flexsurr.config.flight import Control, DoubletTimes
from flexsurr.config.study import Integrator
from flexsurr.flight.equations_of_motion import INPUTS, features_along, motion_with
from flexsurr.flight.model import Doublet, airless
from flexsurr.flight.trim import Trim
from flexsurr.simulation import Trajectory, simulate
from flexsurr.simulation.rhs import Array

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


# Stages at either end of a step lie within it by this share, on their own side of a doublet's jump.
_WITHIN = 1e-9


def fly_stepped(
    trim: Trim,
    pilot: Doublet | None,
    coefficients: Callable[[Array], Array],
    duration_s: float = 5.0,
    step_s: float = 0.005,
) -> Trajectory:
    """As `flexsurr.flight.manoeuvres.fly`, with the 12 coefficients of `coefficients(u)` for u (25,).

    The equations are the compiled ones; RK4 and the aerodynamics are called step by step. Raises ValueError
    for a doublet that jumps within a step.
    """
    model = trim.model.with_doublet(pilot)
    kernel = airless(model)
    steps = round(duration_s / step_s)
    for jump in model.breakpoints:
        if abs(jump / step_s - round(jump / step_s)) > _WITHIN * steps:
            raise ValueError(f"a doublet that jumps at {jump:g} s, within a step of {step_s:g} s")
    t = np.linspace(0.0, duration_s, steps + 1)
    x = np.empty((steps + 1, trim.state.size))
    x[0] = trim.state
    inputs, time = np.empty((1, INPUTS)), np.empty(1)

    def rate(at: float, state: Array) -> Array:
        time[0] = at
        features_along(kernel, time, state[None], inputs)
        dx = np.empty_like(state)
        motion_with(kernel, state, coefficients(inputs[0]), dx)
        return dx

    rows = steps + 1
    for n in range(steps):
        h, start = step_s, x[n]
        k1 = rate(t[n] + _WITHIN * h, start)
        k2 = rate(t[n] + 0.5 * h, start + 0.5 * h * k1)
        k3 = rate(t[n] + 0.5 * h, start + 0.5 * h * k2)
        k4 = rate(t[n] + (1.0 - _WITHIN) * h, start + h * k3)
        x[n + 1] = start + h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4)
        if not np.isfinite(x[n + 1]).all():
            rows = n + 1
            break
    completed = rows == steps + 1
    return Trajectory(
        t=t[:rows],
        x=x[:rows],
        state_names=model.state_names,
        state_units=model.state_units,
        completed=completed,
        reason="" if completed else f"not finite after {t[rows - 1]:g} s",
        end_time_s=float(t[rows - 1]),
        evaluations=4 * min(rows, steps),
        steps=rows - 1,
    )
