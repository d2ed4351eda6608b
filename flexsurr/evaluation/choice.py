"""What the frequencies of a structure ask of its study: durations, steps, ranges and integrators.

docs/choosing.md has the reasons for every rule.
"""

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from flexsurr.beam import ModalBasis, tip_position, tip_twist
from flexsurr.beam.initial_conditions import initial_states
from flexsurr.config.study import InitialConditions, Integrator
from flexsurr.simulation.rhs import Array

STABLE = 5.0
"""Decay rate times step that the explicit method of order 8 bears; rk4 bears 2.8."""

PERIODS = 100.0
"""Of the slowest mode, which a response lasts that nothing damps."""

REACH = 0.5
"""How far the first mode moves the tip at the end of its range: of the length, or rad of twist."""

STRETCH = 0.05
"""The same of a structure that can do no more than stretch."""

KINETIC = 0.25
"""Energy at the end of the momentum's range, of that at the end of the coordinate's."""


def plain(number: float) -> float:
    """The largest of 1, 2 and 5 times a power of ten that is not above `number` > 0."""
    power = 10.0 ** math.floor(math.log10(number))
    return float(f"{max(digit for digit in (1, 2, 5) if digit * power <= number * (1 + 1e-9)) * power:.1g}")


@dataclass(frozen=True, eq=False)
class Choice:
    """What fits the modes of `basis`, of which the first starts at up to `given_deg` [°], of unit norm.

    Without a value it starts as far out as moves the tip by `REACH`.
    """

    basis: ModalBasis
    given_deg: float | None = None

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

    @cached_property
    def q_max_deg(self) -> float:
        """Largest coordinate of the first mode [°], of unit norm; of axial joints 180/π of it are a metre."""
        if self.given_deg is not None:
            return self.given_deg
        stretches = self.basis.structure.ordered_joints == ("axial",)
        tried = np.geomspace(1e-3, 180.0, 1000)
        first = np.radians(tried) / self.basis.unit_norms[0]
        beyond = self._moved(first[:, None] * self.basis.modes[:, 0]) > (STRETCH if stretches else REACH)
        return float(f"{tried[np.argmax(beyond) if beyond.any() else -1]:.2g}")

    @property
    def initial_conditions(self) -> InitialConditions:
        """Where trajectories start: the higher modes as a load of the size that bends the first would."""
        springs = self.basis.stiffness[0, 0] / self.basis.unit_norms[0] ** 2
        at_rest = springs * math.radians(self.q_max_deg) / self.basis.omega_rad_s[0]
        p_max = float(f"{math.sqrt(KINETIC) * at_rest:.2g}")
        return InitialConditions(
            q_min_deg=-self.q_max_deg,
            q_max_deg=self.q_max_deg,
            p_min_kg_m2_s=-p_max,
            p_max_kg_m2_s=p_max,
            higher_modes="as_forced" if len(self.basis.omega_rad_s) > 1 else "alike",
        )

    @property
    def ends(self) -> Array:
        """(r, r) coordinates η, in each row those of one mode at the end of its range and of no other."""
        r = len(self.basis.omega_rad_s)
        unit = np.hstack([0.5 + 0.5 * np.eye(r), np.full((r, r), 0.5)])
        return initial_states(self.basis, self.initial_conditions, unit)[:, :r]

    @property
    def reaches(self) -> Array:
        """(r,) how far each mode alone moves the tip: of the length, or rad of twist if that is more."""
        return self._moved(self.ends @ self.basis.modes.T)

    def _moved(self, q: Array) -> Array:
        """(k,) how far joint coordinates q (k, n) move the tip from where it is undeformed."""
        structure = self.basis.structure
        moved = tip_position(structure, q) - tip_position(structure, 0.0 * q)
        twist = np.abs(tip_twist(structure, q))
        return np.asarray(np.maximum(np.linalg.norm(moved, axis=-1) / structure.length_m, twist))

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
