"""How one run of an integrator over a smooth piece of time ended."""

from typing import NamedTuple

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
