"""What the commands that fly the airliner share: its model, the lattice's forms, and the chosen networks."""

from collections.abc import Mapping
from pathlib import Path

from flexsurr.cli.command import Job
from flexsurr.config.aircraft import Aircraft
from flexsurr.config.feature_limits import FeatureLimits
from flexsurr.config.flight import FlightSettings
from flexsurr.config.panels import PanelCounts
from flexsurr.evaluation.airliner_models import Airliner, airliner, lattices
from flexsurr.simulation.mapping import CompiledMapping
from flexsurr.storage import StorageError, read_json
from flexsurr.surrogates import NetworkMap, load_map


def airliner_of(job: Job) -> Airliner:
    """The airliner that the job's aircraft, flight and panels describe."""
    return airliner(
        Aircraft.model_validate(job["aircraft"]),
        FlightSettings.model_validate(job["flight"]),
        FeatureLimits.model_validate(job["limits"]),
        PanelCounts.model_validate(job["panels"]),
    )


def forms_of(
    job: Job, plane: Airliner, networks: Mapping[str, NetworkMap], with_rebuild: bool
) -> dict[str, CompiledMapping]:
    """The lattice's forms with the samples' boundary condition, and the networks."""
    return {
        **lattices(plane, job["boundary_condition"], with_rebuild=with_rebuild),
        **{label: network.compiled() for label, network in networks.items()},
    }


def selected_networks(selection: Path, runs: Path) -> dict[str, NetworkMap]:
    """The networks that `selection` names by their labels, "network" first, if any has finished.

    Raises StorageError where it names a run that is none.
    """
    chosen = read_json(selection)
    labels = sorted(chosen, key=lambda label: label != "network")
    return {
        label: _network(runs / chosen[label]["run_id"] / "weights.npz")
        for label in labels
        if chosen[label]["architecture"] == "network"
    }


def _network(path: Path) -> NetworkMap:
    learned = load_map(path)
    if not isinstance(learned, NetworkMap):
        raise StorageError(f"{path}: a map of the kind {learned.kind!r}, expected a network")
    return learned
