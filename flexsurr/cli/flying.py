"""What the commands that fly the airliner share: its model, the lattice's forms, and the chosen network."""

import json
from pathlib import Path

from flexsurr.cli.command import Job
from flexsurr.config.aircraft import Aircraft
from flexsurr.config.flight import FlightSettings
from flexsurr.config.panels import PanelCounts
from flexsurr.evaluation.airliner_models import Airliner, airliner, lattices
from flexsurr.simulation.mapping import CompiledMapping
from flexsurr.storage import StorageError
from flexsurr.surrogates.coefficient_network import CoefficientNetwork, load_coefficient_network


def airliner_of(job: Job) -> Airliner:
    """The airliner that the job's aircraft, flight and panels describe."""
    return airliner(
        Aircraft.model_validate(job["aircraft"]),
        FlightSettings.model_validate(job["flight"]),
        PanelCounts.model_validate(job["panels"]),
    )


def forms_of(
    job: Job, plane: Airliner, network: CoefficientNetwork, with_rebuild: bool
) -> dict[str, CompiledMapping]:
    """The lattice's forms with the samples' boundary condition, and the network."""
    return {
        **lattices(plane, job["boundary_condition"], with_rebuild=with_rebuild),
        "network": network.compiled(),
    }


def selected_network(selection: Path, runs: Path) -> CoefficientNetwork:
    """The network that `selection` names. Raises StorageError where it names none."""
    chosen = json.loads(selection.read_text(encoding="utf-8"))
    if "network" not in chosen:
        raise StorageError(f"{selection}: names no network")
    return load_coefficient_network(runs / chosen["network"]["run_id"] / "weights.npz")
