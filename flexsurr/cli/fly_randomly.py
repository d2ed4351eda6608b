"""Time random flights of the airliner with each form of its aerodynamics, and count what left the limits."""

from functools import partial
from pathlib import Path

from flexsurr.cli.command import Job, command
from flexsurr.cli.flying import airliner_of, forms_of, selected_networks
from flexsurr.cli.frames import write_frame
from flexsurr.config.flight import FlightCondition
from flexsurr.evaluation.airliner_cost import (
    NETWORK,
    OfEachFlight,
    airliner_cost,
    as_cost_rows,
    exceedance_summary,
    fly_all,
)
from flexsurr.evaluation.airliner_flights import random_flights
from flexsurr.evaluation.airliner_models import ONE_MACH, REFERENCE, Airliner, frozen_at
from flexsurr.evaluation.timing import measuring
from flexsurr.flight.trim import TrimNotFound, trim
from flexsurr.simulation.mapping import CompiledMapping
from flexsurr.training.networks import TorchMap, export_error


def main(
    job: Job,
    selection: Path,
    runs: Path,
    flights: Path,
    exceedances: Path,
    cost: Path,
    rows: Path,
    limits: Path,
) -> None:
    """Write every flight, every exceedance, their summaries, and the rows for cost.csv."""
    plane = airliner_of(job)
    networks = selected_networks(selection, runs)
    network = networks.get(NETWORK)
    compiled = forms_of(job, plane, networks, with_rebuild=True)
    forms: dict[str, CompiledMapping | OfEachFlight] = {
        ONE_MACH: lambda condition: frozen_at(plane, condition.mach, job["boundary_condition"]),
        **compiled,
    }
    with measuring():
        flown, left = fly_all(
            plane,
            forms,
            random_flights(plane.settings, plane.limits, partial(_has_trim, plane, compiled[REFERENCE])),
            None if network is None else (network.inputs.low, network.inputs.high),
            None if network is None else TorchMap(network),
        )
    write_frame(flights, flown)
    write_frame(exceedances, left)
    table = airliner_cost(flown)
    of_a_network = table["model"].isin(networks)
    table["export_error"] = [
        export_error(networks[model]) if known else float("nan")
        for model, known in zip(table["model"], of_a_network, strict=True)
    ]
    write_frame(cost, table)
    write_frame(rows, as_cost_rows(table, job["boundary_condition"], plane.settings.step_s))
    write_frame(limits, exceedance_summary(left))


def _has_trim(plane: Airliner, lattice: CompiledMapping, condition: FlightCondition) -> bool:
    try:
        trim(plane.flying(lattice), condition, plane.settings.limits)
    except TrimNotFound:
        return False
    return True


if __name__ == "__main__":
    command(
        main,
        {
            "selection": "the chosen network",
            "runs": "the folder of all runs",
            "flights": "one row a flight and model",
            "exceedances": "one row a flight and input",
            "cost": "one row a model",
            "rows": "the same in the columns of cost.csv",
            "limits": "one row an input",
        },
        expected=(TrimNotFound,),
    )
