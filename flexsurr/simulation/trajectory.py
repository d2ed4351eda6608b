"""What a simulation returns."""

from dataclasses import dataclass

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
