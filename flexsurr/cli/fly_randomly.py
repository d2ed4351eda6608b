"""Time random flights of the airliner with each form of its aerodynamics, and count what left the limits."""

from pathlib import Path

from flexsurr.cli.command import Job, command
from flexsurr.cli.flying import airliner_of, forms_of, selected_network
from flexsurr.cli.frames import write_frame
from flexsurr.evaluation.airliner_cost import (
    OfEachFlight,
    airliner_cost,
    as_cost_rows,
    exceedance_summary,
    fly_all,
)
from flexsurr.evaluation.airliner_flights import random_flights
from flexsurr.evaluation.airliner_models import ONE_MACH, frozen_at
from flexsurr.simulation.mapping import CompiledMapping


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
    network = selected_network(selection, runs)
    forms: dict[str, CompiledMapping | OfEachFlight] = {
        ONE_MACH: lambda condition: frozen_at(plane, condition.mach, job["boundary_condition"]),
        **forms_of(job, plane, network, with_rebuild=True),
    }
    flown, left = fly_all(
        plane, forms, random_flights(plane.settings), (network.input_low, network.input_high)
    )
    write_frame(flights, flown)
    write_frame(exceedances, left)
    table = airliner_cost(flown)
    write_frame(cost, table)
    write_frame(rows, as_cost_rows(table, job["boundary_condition"], plane.settings.step_s))
    write_frame(limits, exceedance_summary(left))


if __name__ == "__main__":
    command(
        main,
        {
            "selection": "the chosen network",
            "runs": "the folder of all runs",
            "flights": "one row a flight and model",
            "exceedances": "one row a flight and input",
            "cost": "airliner_cost.csv",
            "rows": "the same in the columns of cost.csv",
            "limits": "airliner_limits.csv",
        },
    )
