"""The aircraft of a study of samples, in flight with each form of its aerodynamics; errors of its maps."""

import logging
from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pandas as pd

from flexsurr.aerodynamics.features import COEFFICIENTS, FEATURES
from flexsurr.cli.command import Job, for_rules
from flexsurr.cli.runs import SELECTED
from flexsurr.config.aerodynamics import FeatureLimits, PanelCounts
from flexsurr.config.aircraft import Aircraft
from flexsurr.config.flight import CONTROL_NAMES, FlightCondition, FlightSettings
from flexsurr.evaluation.airliner_cost import (
    NETWORK,
    OfEachFlight,
    airliner_cost,
    as_cost_rows,
    exceedance_summary,
    fly_all,
)
from flexsurr.evaluation.airliner_flights import Flight, flown, outputs
from flexsurr.evaluation.airliner_models import (
    ONE_MACH,
    REFERENCE,
    Airliner,
    build_airliner,
    frozen_at,
    lattices,
)
from flexsurr.evaluation.airliner_modes import airliner_modes, left_out_modes
from flexsurr.evaluation.airliner_modes import elastic_modes as what_modes_are
from flexsurr.evaluation.airliner_references import reference_flights
from flexsurr.evaluation.columns import ACCURACY_COLUMNS
from flexsurr.evaluation.timing import measuring
from flexsurr.flight.trim import TrimNotFound, trim, trim_envelope
from flexsurr.simulation.mapping import CompiledMapping
from flexsurr.storage import StorageError, read_all_samples, read_json
from flexsurr.storage.frames import read_frame, write_frame
from flexsurr.surrogates import NetworkMap, load_map
from flexsurr.training.map_data import accuracy as accuracy_of
from flexsurr.training.map_data import held_out_errors, map_data


def airliner_of(job: Job) -> Airliner:
    """The airliner that the job's aircraft, flight and panels describe."""
    return build_airliner(
        Aircraft.model_validate(job["aircraft"]),
        FlightSettings.model_validate(job["flight"]),
        FeatureLimits.model_validate(job["limits"]),
        PanelCounts.model_validate(job["panels"]),
    )


def forms_of(
    job: Job, airliner: Airliner, networks: Mapping[str, NetworkMap], with_rebuild: bool
) -> dict[str, CompiledMapping]:
    """The lattice's forms with the samples' boundary condition, and the networks."""
    return {
        **lattices(airliner, job["boundary_condition"], with_rebuild=with_rebuild),
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


@for_rules(
    **SELECTED,
    datasets="the folder of all samples of the study",
    accuracy="one row an output and map",
    errors="one row a held-out sample",
)
def accuracy(job: Job, selection: Path, runs: Path, datasets: Path, accuracy: Path, errors: Path) -> None:
    """Tabulate the errors of the selected maps, by output, and the network's errors sample by sample.

    The errors are those on the held-out samples. Where no map, or no network, has finished there are columns
    alone.
    """
    tables = []
    found = pd.DataFrame(columns=[*FEATURES, *(f"error_{name}" for name in COEFFICIENTS)], dtype=float)
    for label, chosen in read_json(selection).items():
        name = chosen["variant"]
        read = job["samples"][name]
        shards = [datasets / name / f"shard-{number:04d}.parquet" for number in range(job["shards"])]
        samples = read_all_samples(shards, read["configuration"], read["samples"])
        data = map_data(samples, read["held_out"], read["seed"])
        predicted = load_map(runs / chosen["run_id"] / "weights.npz")(data.u)
        tables.append(accuracy_of(data, predicted, label))
        if label == "network":
            found = held_out_errors(data, predicted)
    write_frame(errors, found)
    none = pd.DataFrame(columns=ACCURACY_COLUMNS)
    write_frame(accuracy, pd.concat(tables, ignore_index=True) if tables else none)


log = logging.getLogger(__name__)


@for_rules(
    TrimNotFound,
    **SELECTED,
    modes="eigenvalues with their errors",
    elastic_modes="what each elastic mode is",
    left_out="what the modes change that the aerodynamics does not know",
    doublets="time histories",
    trims="over the envelope",
)
def fly(
    job: Job,
    selection: Path,
    runs: Path,
    modes: Path,
    left_out: Path,
    elastic_modes: Path,
    doublets: Path,
    trims: Path,
) -> None:
    """Trim the airliner, linearise, and fly three doublets, with the lattice and with the network.

    Trims are found over the whole envelope, modes and doublets at the study's own condition.
    """
    airliner = airliner_of(job)
    settings = airliner.settings
    networks = {
        label: network for label, network in selected_networks(selection, runs).items() if label == NETWORK
    }
    forms = forms_of(job, airliner, networks, with_rebuild=False)
    cruise = {}
    for name, mapping in forms.items():
        try:
            cruise[name] = trim(airliner.flying(mapping), settings.condition, settings.limits)
        except TrimNotFound as error:
            raise TrimNotFound(f"{name}: {error}") from None
    write_frame(modes, airliner_modes(cruise[REFERENCE], cruise.get(NETWORK)))
    write_frame(left_out, left_out_modes(airliner))
    write_frame(elastic_modes, what_modes_are(airliner))
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
        found, missing = trim_envelope(airliner.flying(mapping), conditions, settings.limits)
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


@for_rules(TrimNotFound, output="time histories")
def fly_references(job: Job, output: Path) -> None:
    """Fly the random flights with the frozen lattice, which other aerodynamics are held against."""
    write_frame(output, reference_flights(airliner_of(job), job["boundary_condition"]))


@for_rules(
    TrimNotFound,
    **SELECTED,
    references="time histories with the frozen lattice",
    flights="one row a flight and model",
    exceedances="one row a flight and input",
    cost="one row a model",
    rows="the same in the columns of cost.csv",
    limits="one row an input",
)
def fly_randomly(
    job: Job,
    selection: Path,
    runs: Path,
    references: Path,
    flights: Path,
    exceedances: Path,
    cost: Path,
    rows: Path,
    limits: Path,
) -> None:
    """Time random flights with each form of the aerodynamics; count inputs beyond the limits.

    `flights` and `exceedances` have all of them, the others their summaries.
    """
    from flexsurr.training.networks import TorchMap, export_error  # here, for torch takes seconds

    airliner = airliner_of(job)
    networks = selected_networks(selection, runs)
    network = networks.get(NETWORK)
    compiled = forms_of(job, airliner, networks, with_rebuild=True)
    forms: dict[str, CompiledMapping | OfEachFlight] = {
        ONE_MACH: lambda condition: frozen_at(airliner, condition.mach, job["boundary_condition"]),
        **compiled,
    }
    with measuring():
        flown, left = fly_all(
            airliner,
            forms,
            read_frame(references),
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
    write_frame(rows, as_cost_rows(table, job["boundary_condition"], airliner.settings.step_s))
    write_frame(limits, exceedance_summary(left))
