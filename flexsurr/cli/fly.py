"""Trim the airliner, linearise, and fly the three doublets, with the lattice and with the network."""

import logging
from pathlib import Path

import numpy as np
import pandas as pd

from flexsurr.cli.command import Job, command
from flexsurr.cli.flying import airliner_of, forms_of, selected_networks
from flexsurr.cli.frames import write_frame
from flexsurr.config.flight import CONTROL_NAMES, FlightCondition
from flexsurr.evaluation.airliner_cost import NETWORK
from flexsurr.evaluation.airliner_flights import Flight, flown, outputs
from flexsurr.evaluation.airliner_models import REFERENCE
from flexsurr.evaluation.airliner_modes import airliner_modes, left_out_modes
from flexsurr.evaluation.airliner_modes import elastic_modes as what_modes_are
from flexsurr.flight.trim import TrimNotFound, trim, trim_envelope

log = logging.getLogger(__name__)


def main(
    job: Job,
    selection: Path,
    runs: Path,
    modes: Path,
    left_out: Path,
    elastic_modes: Path,
    doublets: Path,
    trims: Path,
) -> None:
    """Write eigenvalues and elastic modes, the doublets' time histories, and trims over the envelope."""
    plane = airliner_of(job)
    settings = plane.settings
    networks = {
        label: network for label, network in selected_networks(selection, runs).items() if label == NETWORK
    }
    forms = forms_of(job, plane, networks, with_rebuild=False)
    cruise = {}
    for name, mapping in forms.items():
        try:
            cruise[name] = trim(plane.flying(mapping), settings.condition, settings.limits)
        except TrimNotFound as error:
            raise TrimNotFound(f"{name}: {error}") from None
    write_frame(modes, airliner_modes(cruise[REFERENCE], cruise.get(NETWORK)))
    write_frame(left_out, left_out_modes(plane))
    write_frame(elastic_modes, what_modes_are(plane))
    histories = []
    for control in CONTROL_NAMES:
        flight = Flight(0, control, settings.condition, settings.doublet_deg)
        for name, start in cruise.items():
            trajectory = flown(start, flight, settings)
            history = pd.DataFrame(outputs(trajectory))
            history.insert(0, "t_s", trajectory.t)
            history.insert(0, "control", control)
            history.insert(0, "model", name)
            histories.append(history)
    write_frame(doublets, pd.concat(histories, ignore_index=True))
    conditions = [
        FlightCondition(mach=mach, altitude_m=altitude)
        for altitude in settings.envelope_altitude_m
        for mach in settings.envelope_mach
    ]
    rows = []
    for name, mapping in forms.items():
        found, missing = trim_envelope(plane.flying(mapping), conditions, settings.limits)
        for reason in missing:
            log.warning("%s: %s", name, reason)
        for point in found:
            row = {"model": name, **point.condition.model_dump()}
            row["alpha_deg"] = float(np.degrees(point.alpha_rad))
            row["i_t_deg"] = float(np.degrees(point.model.controls[0]))
            row["thrust_N"] = point.model.thrust_N
            row.update({f"eta_{k}": float(value) for k, value in enumerate(point.eta, start=1)})
            rows.append(row)
    write_frame(trims, pd.DataFrame(rows))


if __name__ == "__main__":
    command(
        main,
        {
            "selection": "the chosen network",
            "runs": "the folder of all runs",
            "modes": "eigenvalues with their errors",
            "elastic_modes": "what each elastic mode is",
            "left_out": "what the modes change that the aerodynamics does not know",
            "doublets": "time histories",
            "trims": "over the envelope",
        },
        expected=(TrimNotFound,),
    )
