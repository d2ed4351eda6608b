"""What the airliner's aerodynamics is sampled with: its lattice's panels, and the features' intervals.

Intervals are those of config/aircraft/*_limits.yaml.
"""

from pathlib import Path
from typing import Annotated, Self

from pydantic import Field, model_validator

from flexsurr.config.flight import Control
from flexsurr.config.reading import Source, build, read_yaml
from flexsurr.config.schema import Record

Panels = Annotated[int, Field(ge=2)]


class PanelCounts(Record):
    """Strips along each half (or only) span, and panels along the chord: 360 panels in all by default."""

    wing: tuple[Panels, Panels] = (24, 5)
    """Along each half span and along the chord; along the span at least one for each part that sections and
    control surfaces make of it.
    """
    horizontal_tail: tuple[Panels, Panels] = (10, 4)
    """The same."""
    vertical_tail: tuple[Panels, Panels] = (10, 4)
    """Along its only span and along the chord."""


LARGEST_MACH = 0.95
HIGHEST_M = 20000.0


class FeatureLimit(Record):
    """From `low` to `high`, and why so far."""

    low: float
    """Least value."""
    high: float
    """Largest value, above the least."""
    reason: Annotated[str, Field(min_length=1)]
    """Why so far: a sentence for the reader."""

    @model_validator(mode="after")
    def _ordered(self) -> Self:
        if self.low >= self.high:
            raise ValueError(f"low: {self.low:g} is not allowed; allowed: below high: {self.high:g}")
        return self


SixLimits = Annotated[tuple[FeatureLimit, ...], Field(min_length=6, max_length=6)]


class FeatureLimits(Record):
    """A limit for each of the 25 inputs of the aerodynamics, in their order; angles in degrees here."""

    mach: FeatureLimit
    """Mach number, above 0 and below 0.95."""
    altitude_m: FeatureLimit
    """Altitude in the standard atmosphere, 0 to 20,000 [m]."""
    alpha_deg: FeatureLimit
    """Angle of attack, positive nose up [°]."""
    beta_deg: FeatureLimit
    """Sideslip, positive where the air comes from the right [°]."""
    p_over_V_rad_m: FeatureLimit
    """Roll rate over airspeed, positive right wing down [rad/m]."""
    q_over_V_rad_m: FeatureLimit
    """Pitch rate over airspeed, positive nose up [rad/m]."""
    r_over_V_rad_m: FeatureLimit
    """Yaw rate over airspeed, positive nose right [rad/m]."""
    i_t_deg: FeatureLimit
    """Incidence of the horizontal tail, positive leading edge up [°]."""
    delta_e_left_deg: FeatureLimit
    """Left elevator, positive trailing edge down [°]."""
    delta_e_right_deg: FeatureLimit
    """Right elevator, positive trailing edge down [°]."""
    delta_a_left_deg: FeatureLimit
    """Left aileron, positive trailing edge down [°]."""
    delta_a_right_deg: FeatureLimit
    """Right aileron, positive trailing edge down [°]."""
    delta_r_deg: FeatureLimit
    """Rudder, positive trailing edge left [°]."""
    eta: SixLimits
    """Amplitudes of the modes that the aerodynamics feels, mass-normalised, in the order of aerodynamic_modes
    [kg^½ m].
    """
    eta_dot_over_V: SixLimits
    """Their rates over the airspeed [kg^½]."""

    def deflection_deg(self, control: Control) -> float:
        """How far a doublet of `control` may go to either side within its limits."""
        moved = {
            "elevator": (self.delta_e_left_deg, self.delta_e_right_deg),
            "aileron": (self.delta_a_left_deg, self.delta_a_right_deg),
            "rudder": (self.delta_r_deg,),
        }
        return min(min(-limit.low, limit.high) for limit in moved[control])

    @model_validator(mode="after")
    def _means_something(self) -> Self:
        if not 0.0 < self.mach.low < self.mach.high < LARGEST_MACH:
            raise ValueError(
                f"mach: {self.mach.low:g} to {self.mach.high:g} is not allowed; allowed: above 0 and below "
                f"{LARGEST_MACH}, where Prandtl–Glauert's rule ends"
            )
        if not 0.0 <= self.altitude_m.low < self.altitude_m.high <= HIGHEST_M:
            raise ValueError(
                f"altitude_m: {self.altitude_m.low:g} to {self.altitude_m.high:g} is not allowed; allowed: "
                f"0 to {HIGHEST_M:g}, where the standard atmosphere ends"
            )
        return self


def load_feature_limits(path: Path, shown: str | None = None) -> FeatureLimits:
    """The limits of the YAML file at `path`, named `shown` in errors.

    Raises ConfigurationError with one line a mistake: file, key, value and what is allowed.
    """
    name = shown or str(path)
    return build(FeatureLimits, [Source(name, read_yaml(path, name))])
