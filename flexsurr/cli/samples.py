"""Samples of the airliner's aerodynamics."""

import logging
from pathlib import Path

from flexsurr.aerodynamics.features import COEFFICIENT_UNITS, COEFFICIENTS, FEATURE_UNITS, FEATURES
from flexsurr.aerodynamics.sampling import draw_features, feature_intervals, linear_in_modes
from flexsurr.aerodynamics.vortex_lattice import rebuilt
from flexsurr.cli.batch import make_all, shards_of
from flexsurr.cli.command import Job, for_rules
from flexsurr.config.aerodynamics import FeatureLimits, PanelCounts
from flexsurr.config.aircraft import Aircraft
from flexsurr.config.schema import part_of
from flexsurr.config.trial import sample_name
from flexsurr.flight.airliner import flexible_airframe
from flexsurr.flight.modes import free_modes
from flexsurr.flight.stick_model import stick_model
from flexsurr.storage import SampleMetadata, Samples, write_samples

log = logging.getLogger(__name__)


@for_rules(output="the shard")
def sample(job: Job, output: Path) -> None:
    """Sample one shard of the airliner's aerodynamics: the rebuilt lattice at random features.

    It holds the samples `first` to `first + count − 1` of the job's sequence.
    """
    aircraft = part_of(Aircraft, job["aircraft"])
    modes = free_modes(stick_model(aircraft), job["elastic_modes"])
    airframe = flexible_airframe(
        modes, PanelCounts.model_validate(job["panels"]), tuple(job["aerodynamic_modes"])
    )
    low, high = feature_intervals(FeatureLimits.model_validate(job["limits"]))
    u = draw_features(
        low,
        high,
        seed=job["seed"],
        first=job["first"],
        count=job["count"],
        sampling=job["sampling"],
    )
    form = rebuilt(airframe, job["boundary_condition"])
    y = linear_in_modes(form, u) if job["lattice"] == "linear_in_modes" else form(u)
    metadata = SampleMetadata(
        study=job["study"],
        sampling=sample_name(job["sampling"], job["lattice"]),
        seed=job["seed"],
        configuration=job["configuration"],
        first=job["first"],
        count=job["count"],
        input_names=FEATURES,
        input_units=FEATURE_UNITS,
        input_low=tuple(low.tolist()),
        input_high=tuple(high.tolist()),
        output_names=COEFFICIENTS,
        output_units=COEFFICIENT_UNITS,
    )
    write_samples(output, Samples(u, y, metadata))
    log.info("%s: %d samples of %d panels", output, len(u), len(airframe.lattice))


@for_rules(results="the folder of results", output="what is made")
def sample_shards(job: Job, results: Path, output: Path) -> None:
    """Sample a batch of shards of the airliner's aerodynamics: those that are missing or out of date.

    They lie below `results`; `output` lists them.
    """
    make_all(shards_of(job, results, sample), results, output)
