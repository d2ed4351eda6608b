"""The balance of energy along a response: work of the load = change of energy + what the dampers took."""

from dataclasses import dataclass

import numpy as np
from scipy.integrate import cumulative_simpson

from flexsurr.beam import BeamModel, Load, ModalBasis, loaded
from flexsurr.simulation.rhs import Array


@dataclass(frozen=True)
class EnergyBalance:
    """From the first sample on, (k,) [J]: work of the load, change of the energy, energy dissipated."""

    work: Array
    change: Array
    dissipated: Array

    @property
    def residual(self) -> Array:
        """(k,) [J] work − change − dissipated: of the hamiltonian variant zero, but for the steps."""
        return self.work - self.change - self.dissipated


def energy_balance(
    model: BeamModel, basis: ModalBasis, load: Load | None, t: Array, x: Array
) -> EnergyBalance:
    """The balance of a reduced-order `model` along its states x (k, 2r) at times t (k,) [s].

    Powers Q·η̇ and η̇ᵀ C η̇ at the samples are integrated by Simpson's rule, so the samples must be close
    and the load smooth between the first and the last: split the response where the load jumps. A model
    that drops the gyroscopic term has no such balance.
    """
    r = basis.modes.shape[1]
    field = np.array([model.derivative(time, state) for time, state in zip(t, x, strict=True)])
    rates = field[:, :r]
    force = np.zeros_like(rates)
    if load is not None:
        under_load = loaded(model, basis, load, "numpy")
        force = np.array([under_load.derivative(time, state) for time, state in zip(t, x, strict=True)])[
            :, r:
        ]
        force -= field[:, r:]
    energy = model.energy(x)
    taken = np.sum(rates * (rates @ basis.damping), axis=1)
    return EnergyBalance(
        work=_integral(np.sum(force * rates, axis=1), t),
        change=energy - energy[0],
        dissipated=_integral(taken, t),
    )


def _integral(power: Array, t: Array) -> Array:
    return np.asarray(cumulative_simpson(power, x=t, initial=0.0))
