"""The random flights with the lattice frozen, which the other forms of aerodynamics are held against.

They take a minute or two, and errors need them all; nothing is timed here.
"""

import logging

import pandas as pd

from flexsurr.aerodynamics.boundary import BoundaryCondition
from flexsurr.config.flight import FlightCondition
from flexsurr.evaluation.airliner_flights import flown, history, random_flights
from flexsurr.evaluation.airliner_models import ONE_MACH, REFERENCE, Airliner, frozen_at, lattices
from flexsurr.flight.trim import Trim, TrimNotFound, trim

log = logging.getLogger(__name__)


def reference_flights(airliner: Airliner, boundary_condition: BoundaryCondition) -> pd.DataFrame:
    """Every random flight with the models `REFERENCE` and `ONE_MACH`, from their trims: each one's `history`.

    Where `ONE_MACH` has no trim it does not fly, and the log says so.
    """
    settings = airliner.settings
    exact = lattices(airliner, boundary_condition, with_rebuild=False)[REFERENCE]
    trims: dict[FlightCondition, Trim] = {}

    def has_trim(condition: FlightCondition) -> bool:
        try:
            trims[condition] = trim(airliner.flying(exact), condition, settings.limits)
        except TrimNotFound:
            return False
        return True

    histories = []
    for flight in random_flights(settings, airliner.limits, has_trim):
        starts = {REFERENCE: trims[flight.condition]}
        at_one_mach = frozen_at(airliner, flight.condition.mach, boundary_condition)
        try:
            starts[ONE_MACH] = trim(airliner.flying(at_one_mach), flight.condition, settings.limits)
        except TrimNotFound as error:
            log.warning("flight %d, %s: %s", flight.number, ONE_MACH, error)
        histories += [
            history(model, flight, flown(start, flight, settings)) for model, start in starts.items()
        ]
        log.info("flight %d: %s of %.1f deg", flight.number, flight.control, flight.amplitude_deg)
    return pd.concat(histories, ignore_index=True)
