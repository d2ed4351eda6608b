"""The airliner in flight with each form of its aerodynamics: lattice rebuilt, frozen, quadratic, network."""

from dataclasses import dataclass, fields, replace

import numpy as np

from flexsurr.aerodynamics.airframe import Airframe, ModalMotion
from flexsurr.aerodynamics.boundary import BoundaryCondition
from flexsurr.aerodynamics.mach_grid import fixed_machs, mach_grid
from flexsurr.aerodynamics.quadratic import quadratic
from flexsurr.aerodynamics.sampling import draw_features, feature_intervals
from flexsurr.aerodynamics.vortex_lattice import frozen, rebuilt
from flexsurr.config.aerodynamics import FeatureLimits, PanelCounts
from flexsurr.config.aircraft import Aircraft
from flexsurr.config.flight import FlightSettings
from flexsurr.evaluation.columns import REBUILT
from flexsurr.evaluation.operations import counted_outputs
from flexsurr.flight import FreeModes, free_modes, stick_model
from flexsurr.flight.airliner import flexible_airframe
from flexsurr.flight.model import FlightModel
from flexsurr.simulation.mapping import CompiledMapping

REFERENCE = "vlm_frozen"
"""What the others are compared with: the lattice with frozen matrices, as exact as the rebuilt one."""

ONE_MACH = "vlm_frozen_one_mach"
"""The lattice frozen at the Mach number of each flight's trim: see `frozen_at`."""

_MACH_MARGIN = 0.05
_LARGEST_MACH = 0.94


@dataclass(frozen=True, eq=False)
class Airliner:
    """An aircraft with its modes, its airframe, the settings of its flights, and what it may meet in them.

    `limits` are those of the samples that surrogates are trained on.
    """

    settings: FlightSettings
    limits: FeatureLimits
    modes: FreeModes
    airframe: Airframe

    def flying(self, aerodynamics: CompiledMapping) -> FlightModel:
        """The model of its flight with one aerodynamics."""
        return FlightModel(self.modes, aerodynamics, chosen=self.settings.aerodynamic_modes)


def build_airliner(
    aircraft: Aircraft, settings: FlightSettings, limits: FeatureLimits, counts: PanelCounts | None = None
) -> Airliner:
    """The airliner of an aircraft file, flown by `settings` within `limits`."""
    modes = free_modes(stick_model(aircraft), settings.elastic_modes)
    return Airliner(settings, limits, modes, flexible_airframe(modes, counts, settings.aerodynamic_modes))


def frozen_at(
    airliner: Airliner, mach: float, boundary_condition: BoundaryCondition = "exact"
) -> CompiledMapping:
    """The lattice with matrices frozen at a single Mach number, which stays that of the flight's trim.

    The cheapest lattice there is; `REFERENCE` interpolates between three and costs three times as much.
    """
    return frozen(airliner.airframe, fixed_machs([mach]), boundary_condition)


def lattices(
    airliner: Airliner, boundary_condition: BoundaryCondition = "exact", with_rebuild: bool = True
) -> dict[str, CompiledMapping]:
    """The lattice's forms by name: vlm_rebuild (if asked for), vlm_frozen, quadratic.

    The frozen ones know the Mach numbers of the settings and the limits, and a little beyond. The quadratic
    form's boundary condition is linear, whatever that of the others.
    """
    settings = airliner.settings
    machs = [
        *settings.envelope_mach,
        airliner.limits.mach.low,
        airliner.limits.mach.high,
        settings.condition.mach,
    ]
    grid = mach_grid(max(min(machs) - _MACH_MARGIN, 0.0), min(max(machs) + _MACH_MARGIN, _LARGEST_MACH))
    forms = {REBUILT: rebuilt(airliner.airframe, boundary_condition)} if with_rebuild else {}
    return {
        **forms,
        REFERENCE: frozen(airliner.airframe, grid, boundary_condition),
        "quadratic": quadratic(airliner.airframe, grid),
    }


def lattice_operations(airliner: Airliner, boundary_condition: BoundaryCondition = "exact") -> dict[str, int]:
    """What one call of each form of the lattice takes, by its name.

    Of the rebuilt one, whose every pair of panels takes as much as any other and every panel nearly as much,
    the first two, three and four panels tell what all N take, to 1 %. LAPACK's solution is added to it,
    2/3 N³ + 2 N² operations; what it does with the geometry alone, before the Mach number comes in, is not
    counted.
    """
    (u,) = draw_features(*feature_intervals(airliner.limits), seed=0, first=0, count=1)
    at_one_mach = frozen_at(airliner, airliner.settings.condition.mach, boundary_condition)
    forms = {**lattices(airliner, boundary_condition, with_rebuild=False), ONE_MACH: at_one_mach}
    few, n = (2, 3, 4), len(airliner.airframe.lattice)
    parts = [rebuilt(_first_panels(airliner.airframe, count), boundary_condition) for count in few]
    taken = np.polyfit(few, [counted_outputs(part, u)[1] for part in parts], 2)
    return {
        REBUILT: round(float(np.polyval(taken, n)) + 2 / 3 * n**3 + 2 * n**2),
        **{name: counted_outputs(form, u)[1] for name, form in forms.items()},
    }


def _first_panels(airframe: Airframe, count: int) -> Airframe:
    """The airframe of no more than its first panels."""
    lattice, motion = airframe.lattice, airframe.motion
    panels = {each.name: getattr(lattice, each.name)[:count] for each in fields(lattice)}
    return replace(
        airframe,
        lattice=replace(lattice, **panels | {"surfaces": lattice.surfaces}),
        motion=ModalMotion(*(getattr(motion, each.name)[:count] for each in fields(motion))),
    )
