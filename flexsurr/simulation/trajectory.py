"""What a simulation returns, and how each run of an integrator within it ended."""

from dataclasses import dataclass
from typing import NamedTuple

from flexsurr.simulation.rhs import Array


@dataclass(frozen=True, slots=True)
class Trajectory:
    """Samples of a state over time, as far as the integrator came, and what they cost.

    Of m requested samples the first k are there: k = m if `completed`, else those before the failure.
    Every value is finite.
    """

    t: Array
    """Sample times [s], (k,)."""
    x: Array
    """States at the samples, (k, d), in `state_units`."""
    state_names: tuple[str, ...]
    state_units: tuple[str, ...]
    completed: bool
    reason: str
    """Why the simulation ended early; empty if it completed."""
    end_time_s: float
    """Time of the last accepted state [s]; the last sample's if it completed."""
    evaluations: int
    """Evaluations of the right-hand side, those for Jacobians included."""
    steps: int
    """Accepted steps."""


COMPLETED, NOT_FINITE, STEP_TOO_SMALL, NOT_CONVERGED = range(4)

_REASONS = {
    COMPLETED: "",
    NOT_FINITE: "the state left the finite numbers",
    STEP_TOO_SMALL: "the step size fell below the spacing of floating-point numbers",
    NOT_CONVERGED: "the stage equations did not converge at this step size",
}


class Outcome(NamedTuple):
    """Counts and end of a run; `rows` of the requested states are written."""

    rows: int
    end_time_s: float
    evaluations: int
    steps: int
    reason: str


def from_compiled(rows: int, end_time_s: float, evaluations: int, steps: int, status: int) -> Outcome:
    """The outcome that a compiled integrator reports by a status number."""
    reason = _REASONS[status]
    if reason:
        reason = f"{reason} (after t = {end_time_s:.6g} s)"
    return Outcome(rows, end_time_s, evaluations, steps, reason)
