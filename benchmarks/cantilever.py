"""The cantilever of the study and its data, for benchmarks of learning."""

from pathlib import Path

import numpy as np
import yaml

from flexsurr.beam import draw_initial_conditions, reduce, reduced_order
from flexsurr.config.structure import Structure
from flexsurr.config.study import DatasetSettings, Reduction, Variant
from flexsurr.simulation import CompiledModel, simulate
from flexsurr.training import Dataset, split_dataset

STRUCTURE = Path(__file__).parents[1] / "config/structures/cantilever.yaml"
SEED = 2024


def cantilever_model(variant: Variant) -> CompiledModel:
    """The compiled reduced-order model, one mode of unit norm."""
    return reduced_order(_basis(), variant, "compiled")


def cantilever_dataset(variant: Variant) -> Dataset:
    """The study's 50 free responses, every fifth of them to validate on."""
    settings, model = DatasetSettings(), cantilever_model(variant)
    t = np.arange(0.0, settings.duration_s + 0.5 * settings.step_s, settings.step_s)
    starts = draw_initial_conditions(_basis(), settings.initial_conditions, SEED, 0, settings.trajectories)
    x = np.concatenate([simulate(model, t, start, settings.integrator).x for start in starts])
    return split_dataset(
        np.repeat(np.arange(len(starts)), t.size),
        x,
        np.array([model.derivative(0.0, state) for state in x]),
        validation=range(0, len(starts), 5),
        state_names=model.state_names,
        state_units=model.state_units,
    )


def _basis():
    return reduce(Structure(**yaml.safe_load(STRUCTURE.read_text())), Reduction(modes=1))
