"""What the study published, for the columns beside ours."""

import math
from collections.abc import Mapping
from typing import Any, NamedTuple

import pandas as pd


class Recipe(NamedTuple):
    """How the study trained the networks of one structure (its section 4.2), and the losses it came to."""

    architectures: tuple[str, ...]
    settings: Mapping[str, Any]
    loss: float  # training and validation loss are "proportional to" it


_ADAM = {"activation": "elu", "optimiser": "adam", "batch_size": 64}
RECIPES: dict[str, Recipe] = {
    "cantilever": Recipe(
        ("mlp", "hnn"), {"hidden": "128", "learning_rate": 1e-5, "epoch_limit": 5000, **_ADAM}, 1e-7
    ),
    "wing": Recipe(
        ("mlp", "dissipative_hnn"),
        {"hidden": "256", "learning_rate": 1e-4, "epoch_limit": 20000, **_ADAM},
        1e-6,
    ),
}


class Cost(NamedTuple):
    """Wall time of a network's response over that of the reduced model [%]: mean and standard deviation."""

    mean_percent: float
    std_percent: float


# By name of the structure, architecture and response (section 4.3).
COSTS: dict[str, dict[tuple[str, str], Cost]] = {
    "cantilever": {
        ("hnn", "free"): Cost(1.29, 0.07),
        ("mlp", "free"): Cost(0.78, 0.06),
        ("hnn", "forced"): Cost(83.60, 4.63),
        ("mlp", "forced"): Cost(82.72, 4.34),
    },
    "wing": {
        ("dissipative_hnn", "free"): Cost(12.38, 4.07),
        ("mlp", "free"): Cost(8.99, 4.13),
        ("dissipative_hnn", "forced"): Cost(51.91, 5.84),
        ("mlp", "forced"): Cost(56.39, 2.56),
    },
}

# Table 3: natural frequencies [rad/s] of the wing, full order and reduced order.
_TABLE_3 = (
    (2.21, 9.55, 13.78, 27.39, 36.38, 46.69, 63.14, 65.05, 80.53),
    (2.21, 9.59, 13.83, 27.63, 37.02, 47.14, 64.28, 67.54, 84.65),
)

# By name of the structure: full order, reduced order.
FREQUENCIES_RAD_S: dict[str, tuple[tuple[float, ...], tuple[float, ...]]] = {
    "wing": _TABLE_3,
    "wing_as_printed": _TABLE_3,
}


def is_of_the_recipe(run: Mapping[str, Any]) -> bool:
    """Whether a run (its metrics) was trained by the study's own recipe for its structure."""
    recipe = RECIPES.get(run.get("structure", ""))
    return (
        recipe is not None
        and run["architecture"] in recipe.architectures
        and all(run.get(key) == value for key, value in recipe.settings.items())
    )


def published_loss(run: Mapping[str, Any]) -> float:
    """The loss that the study came to by the recipe of `run` (its metrics); NaN for any other run."""
    return RECIPES[run["structure"]].loss if is_of_the_recipe(run) else math.nan


def beside(costs: pd.DataFrame, structure: str, recipes: Mapping[str, str]) -> pd.DataFrame:
    """`costs` with paper_percent and paper_std_percent, where the study published what a row measures.

    `recipes` maps the names of the models that were trained by the study's recipe to their architectures. A
    published figure is a network in torch against the reduced model in Python loops, both with SciPy's Radau
    at default tolerances: it stands on that row of its network and on no other.
    """
    published = COSTS.get(structure, {})
    columns = (costs[name].astype(str) for name in ("model", "response", "implementation", "integrator"))
    found = [
        published.get((recipes.get(model, ""), response), Cost(math.nan, math.nan))
        if (implementation, integrator) == ("torch", "scipy_radau")
        else Cost(math.nan, math.nan)
        for model, response, implementation, integrator in zip(*columns, strict=True)
    ]
    return costs.assign(
        paper_percent=[cost.mean_percent for cost in found],
        paper_std_percent=[cost.std_percent for cost in found],
    )
