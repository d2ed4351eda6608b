"""The damped wing of the study and its data, for benchmarks of learning."""

from dataclasses import replace
from pathlib import Path
from typing import Literal

import numpy as np
import yaml

from flexsurr.beam import draw_initial_conditions, reduce, reduced_order
from flexsurr.config.structure import Structure
from flexsurr.config.study import InitialConditions, Integrator, Reduction, Variant
from flexsurr.simulation import CompiledModel, simulate
from flexsurr.training import Dataset, split_dataset

STRUCTURE = Structure(
    **yaml.safe_load((Path(__file__).parents[1] / "config/structures/wing.yaml").read_text())
)
Kind = Literal["modal", "joint"]
SEED = 2024
FIRST_OF_MANY, FRESH = 1000, 100_000  # numbers of trajectories that the study's own 50 do not use
ACCURATE = Integrator(method="radau_iia_5", rtol=1e-9, atol=1e-11)


def basis():
    """Three mass-normalised modes."""
    return reduce(STRUCTURE, Reduction(modes=3, normalisation="mass"))


def wing_model(variant: Variant) -> CompiledModel:
    """The compiled reduced-order model."""
    return reduced_order(basis(), variant, "compiled")


def starts(first: int, count: int, kind: Kind = "modal"):
    """Random initial states: drawn for unit-norm modes, or for every joint."""
    return draw_initial_conditions(basis(), InitialConditions(kind=kind), SEED, first, count)


def free_responses(variant: Variant, kind: Kind, first: int, count: int, t) -> Dataset:
    """Samples at times t of free responses, every fifth of them to validate on."""
    model = wing_model(variant)
    x = np.concatenate([simulate(model, t, start, ACCURATE).x for start in starts(first, count, kind)])
    return split_dataset(
        np.repeat(np.arange(count), t.size),
        x,
        np.array([model.derivative(0.0, state) for state in x]),
        validation=range(0, count, 5),
        state_names=model.state_names,
        state_units=model.state_units,
    )


def datasets(variant: Variant, kind: Kind = "modal") -> dict[str, Dataset]:
    """The study's 50 responses, and 1,000 others of five samples each, validated on all of the 50."""
    fifty = free_responses(variant, kind, 0, 50, np.linspace(0.0, 1.0, 1001))
    others = free_responses(variant, kind, FIRST_OF_MANY, 1000, np.linspace(0.0, 1.0, 5))
    many = replace(
        others,
        x_train=np.concatenate([others.x_train, others.x_validation]),
        dx_train=np.concatenate([others.dx_train, others.dx_validation]),
        x_validation=np.concatenate([fifty.x_train, fifty.x_validation]),
        dx_validation=np.concatenate([fifty.dx_train, fifty.dx_validation]),
    )
    return {"50 responses": fifty, "1,000 x 5": many}


def tip_errors(model, reference, times, responses) -> list[float]:
    """Of each response at `times`, over the peak of the tip's displacement; infinite where it fails."""
    at_rest, errors = reference.tip(np.zeros(6)), []
    for exact in responses:
        found = simulate(model, times, exact[0], ACCURATE)
        if not found.completed:
            errors.append(np.inf)
            continue
        peak = np.max(np.linalg.norm(reference.tip(exact) - at_rest, axis=1))
        distance = np.linalg.norm(reference.tip(found.x) - reference.tip(exact), axis=1)
        errors.append(float(np.max(distance) / peak))
    return errors
