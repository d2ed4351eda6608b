"""What the frequencies of a structure ask of its study: durations, steps, ranges and integrators.

docs/choosing.md has the reasons for every rule.
"""

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from flexsurr.beam import ModalBasis, tip_position
from flexsurr.config.study import Integrator
from flexsurr.simulation.rhs import Array

STABLE = 5.0
"""Decay rate times step that the explicit method of order 8 bears; rk4 bears 2.8."""

PERIODS = 100.0
"""Of the slowest mode, which a response lasts that nothing damps."""


def plain(number: float) -> float:
    """The largest of 1, 2 and 5 times a power of ten that is not above `number` > 0."""
    power = 10.0 ** math.floor(math.log10(number))
    return float(f"{max(digit for digit in (1, 2, 5) if digit * power <= number * (1 + 1e-9)) * power:.1g}")


@dataclass(frozen=True, eq=False)
class Choice:
    """What fits the modes of `basis`, which start at up to `q_max_deg` [°] of unit-norm modes."""

    basis: ModalBasis
    q_max_deg: float = 20.0

    @property
    def slowest_s(self) -> float:
        """Period of the slowest mode [s]."""
        return float(2.0 * math.pi / self.basis.omega_rad_s[0])

    @property
    def fastest_s(self) -> float:
        """Period of the fastest mode that is kept [s]."""
        return float(2.0 * math.pi / self.basis.omega_rad_s[-1])

    @cached_property
    def decay_rates(self) -> Array:
        """(2 r,) rates [1/s] at which free motion about the undeformed shape dies out; 0 without damping."""
        r = len(self.basis.omega_rad_s)
        system = np.block([[np.zeros((r, r)), np.eye(r)], [-self.basis.stiffness, -self.basis.damping]])
        return np.sort(-np.linalg.eigvals(system).real)

    @property
    def sample_step_s(self) -> float:
        """Between the samples of a dataset [s]."""
        return plain(self.fastest_s / 20.0)

    @property
    def sampled_s(self) -> float:
        """Length of a trajectory of a dataset [s]: two periods of the slowest mode, in whole steps."""
        return round(2.0 * self.slowest_s / self.sample_step_s) * self.sample_step_s

    @property
    def output_step_s(self) -> float:
        """Between the samples at which errors are measured, and the longest fixed step [s]."""
        return plain(self.fastest_s / 10.0)

    @property
    def stiff(self) -> bool:
        """Whether damping is faster than an explicit method bears at `output_step_s`."""
        return bool(self.decay_rates[-1] * self.output_step_s > STABLE)

    def response_s(self, periods: float = PERIODS) -> float:
        """Length of an evaluated response [s]: so many periods, or until it has died to a hundredth."""
        lasting = self.decay_rates[self.decay_rates > 1e-9 * self.basis.omega_rad_s[0]]
        longest = periods * self.slowest_s
        lasts = longest if lasting.size == 0 else min(longest, math.log(100.0) / lasting[0])
        return max(round(plain(lasts) / self.output_step_s), 1) * self.output_step_s

    @property
    def momenta_kg_m2_s(self) -> Array:
        """(r,) momentum of each unit-norm mode that has the energy of `q_max_deg`."""
        q_max = math.radians(self.q_max_deg)
        return self.basis.omega_rad_s * q_max / self.basis.unit_norms**2

    @property
    def p_max_kg_m2_s(self) -> float:
        """One range for all modes: that of the mode which moves the least mass."""
        return plain(float(np.min(self.momenta_kg_m2_s)))

    @property
    def reaches(self) -> Array:
        """(r,) how far `q_max_deg` of each mode moves the tip, of the length."""
        structure, q_max = self.basis.structure, math.radians(self.q_max_deg)
        shapes = (self.basis.modes / self.basis.unit_norms).T * q_max
        moved = tip_position(structure, shapes) - tip_position(structure, 0.0 * shapes)
        return np.asarray(np.linalg.norm(moved, axis=-1) / structure.length_m)

    @property
    def integrator(self) -> Integrator:
        """For responses by which runs are chosen and drawn."""
        if self.stiff:
            return Integrator(method="radau_iia_5", rtol=1e-7, atol=1e-9)
        return Integrator(method="dop853_fixed", step_s=self.output_step_s)

    @property
    def tight_integrator(self) -> Integrator:
        """For responses from which errors are measured."""
        if self.stiff:
            return Integrator(method="radau_iia_5", rtol=1e-9, atol=1e-11)
        return Integrator(method="dop853", rtol=1e-12, atol=1e-14)
