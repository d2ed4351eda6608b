"""A surrogate in one file with what it stands for: structure, modes, outputs, and where it was trained."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from flexsurr.beam import ModalBasis, node_positions, tip_position, tip_twist
from flexsurr.config.structure import BEFORE, Structure
from flexsurr.simulation.rhs import Array
from flexsurr.surrogates import Surrogate
from flexsurr.surrogates.saved import load_about, save

MARGIN = 0.05
"""How far beyond the range of its training samples, as part of it, a surrogate is still taken at its word."""


@dataclass(frozen=True, eq=False)
class SavedSurrogate:
    """A surrogate, and what it stands for.

    `low` and `high` (d,) are the least and the largest value of each state over its training samples, in
    the states' units. `basis` has the structure and the modes with q = Φ η, and is None for data that came
    from no structure of ours; `variant` says whether the gyroscopic term was kept.
    """

    surrogate: Surrogate
    study: str
    variant: str
    run_id: str
    low: Array
    high: Array
    basis: ModalBasis | None

    def outside(self, x: Array) -> str:
        """Which state of x (m, d) first leaves the training range, and how far it goes; or nothing."""
        margin = MARGIN * (self.high - self.low)
        beyond = (x < self.low - margin) | (x > self.high + margin)
        if not beyond.any():
            return ""
        state = int(np.argmax(beyond[np.argmax(beyond.any(axis=1))]))
        name, unit = self.surrogate.state_names[state], self.surrogate.state_units[state]
        values = x[:, state]
        furthest = float(values[np.argmax(np.abs(values - 0.5 * (self.low + self.high)[state]))])
        known = f"{self.low[state]:.3g} to {self.high[state]:.3g}"
        return f"{name} reaches {furthest:.3g} {unit}; {self.run_id} was trained from {known}"

    def tip(self, x: Array) -> Array | None:
        """(m, 3) position of the tip [m] in the clamp's frame before it is turned, at states x (m, 2r)."""
        if self.basis is None:
            return None
        return tip_position(self.basis.structure, self._joints(self.basis, x))

    def twist(self, x: Array) -> Array | None:
        """(m,) twist of the tip against the clamp [rad] at states x (m, 2r)."""
        return None if self.basis is None else tip_twist(self.basis.structure, self._joints(self.basis, x))

    def nodes(self, x: Array) -> Array | None:
        """(m, N + 1, 3) ends of the elements [m], the clamp first, at states x (m, 2r)."""
        return (
            None if self.basis is None else node_positions(self.basis.structure, self._joints(self.basis, x))
        )

    @staticmethod
    def _joints(basis: ModalBasis, x: Array) -> Array:
        return x[:, : basis.modes.shape[1]] @ basis.modes.T


def save_surrogate(saved: SavedSurrogate, path: str | Path) -> None:
    """Write the surrogate and what it stands for to `path`, whole or not at all."""
    about: dict[str, Any] = {"study": saved.study, "variant": saved.variant, "run_id": saved.run_id}
    arrays = {"low": saved.low, "high": saved.high}
    if saved.basis is not None:
        about["structure"] = saved.basis.structure.model_dump(mode="json")
        about["normalisation"] = saved.basis.normalisation
        arrays |= {name: getattr(saved.basis, name) for name in ("equilibrium", "modes", "omega_rad_s")}
    save(saved.surrogate, path, about, arrays)


def load_surrogate(path: str | Path) -> SavedSurrogate:
    """The surrogate in `path`. Raises SurrogateFileError for a damaged or foreign file, OSError for none."""
    return load_about(path, _saved)


def _saved(surrogate: Surrogate, about: dict[str, Any], arrays: dict[str, np.ndarray]) -> SavedSurrogate:
    basis = None
    if "structure" in about:
        basis = ModalBasis.of(
            Structure.model_validate(BEFORE | about["structure"]),
            arrays["equilibrium"],
            arrays["modes"],
            arrays["omega_rad_s"],
            about["normalisation"],
        )
        shape = basis.structure.coordinates, len(surrogate.state_names) // 2
        if basis.modes.shape != shape:
            raise ValueError(f"modes of shape {basis.modes.shape} where {shape} is needed")
    return SavedSurrogate(
        surrogate,
        about["study"],
        about["variant"],
        about["run_id"],
        arrays["low"],
        arrays["high"],
        basis,
    )
