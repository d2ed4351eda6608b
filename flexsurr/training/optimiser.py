"""What an optimiser is to `fit`: weights that an epoch makes better, and a state to go on from."""

from typing import Protocol

from flexsurr.simulation.rhs import Array


class Optimiser(Protocol):
    """Advances `parameters` (n,) by an epoch at a time."""

    @property
    def parameters(self) -> Array:
        """The weights."""
        ...

    finished: str
    """Why there is nothing left to do; empty while there is."""

    def epoch(self) -> float:
        """Advance by one epoch; the training loss, not finite if the weights have left the numbers."""
        ...

    def state(self) -> dict[str, Array]:
        """Everything that the next epoch depends on, as arrays."""
        ...

    def restore(self, state: dict[str, Array]) -> None:
        """Go on from a `state`, to the same weights as without the interruption."""
        ...
