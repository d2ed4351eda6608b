"""Result files -> figures and tables: one function each, listed in `FIGURES` and `TABLES`.

A product says what it `reads`, in the order of its function's arguments:

| read | is |
|---|---|
| structure | the study's `Structure` |
| metrics | one row for each run of the study: its metrics.json |
| relatives | the same of every study of the same structure |
| history | all runs' history.parquet, with a column run_id |
| anything else | results/evaluation/<study>/<it>.parquet; a * stands for every file that fits, concatenated |

    figure = FIGURES["figure_10"].make(pd.read_parquet(...))
    save(figure, results / "figures" / "figure_10")

A figure may show what only some structures have: `Product.shows` says of which it is made.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Generic, TypeVar

import pandas as pd
from matplotlib.figure import Figure

from flexsurr.config.structure import Structure
from flexsurr.report import tables
from flexsurr.report.architectures import architecture_errors, architectures
from flexsurr.report.beam_figures import figure_08, figure_09
from flexsurr.report.cost_figures import cost_accuracy
from flexsurr.report.damped_figures import energy_decay, figure_14, figure_15
from flexsurr.report.energy_figures import figure_13
from flexsurr.report.kinematic_figures import figure_03, figure_04
from flexsurr.report.response_figures import figure_10, figure_12
from flexsurr.report.schematics import figure_05, figure_06, figure_07, figure_11
from flexsurr.report.seeds import seeds
from flexsurr.report.style import save
from flexsurr.report.tables import save_page, save_table
from flexsurr.report.training_figures import training_loss

Made = TypeVar("Made")


def any_structure(structure: Structure) -> bool:
    """True."""
    return True


def conservative(structure: Structure) -> bool:
    """Whether nothing of the structure is damped."""
    return not structure.dissipates


def damped(structure: Structure) -> bool:
    """Whether something of the structure is damped."""
    return structure.dissipates


@dataclass(frozen=True)
class Product(Generic[Made]):
    """A figure or a table: its title, the function that makes it, and what that reads, in order.

    `shows` says of which structures it is made.
    """

    title: str
    make: Callable[..., Made]
    reads: tuple[str, ...] = ()
    shows: Callable[[Structure], bool] = any_structure


FIGURES: dict[str, Product[Figure]] = {
    "figure_03": Product("Discretisation", figure_03, ("structure",)),
    "figure_04": Product("Frames and position vectors", figure_04, ("structure",)),
    "figure_05": Product("Multilayer perceptron", figure_05),
    "figure_06": Product("Hamiltonian neural network", figure_06, shows=conservative),
    "figure_07": Product("Dissipative Hamiltonian neural network", figure_07, shows=damped),
    "figure_08": Product("Tip under static loads", figure_08, ("statics",)),
    "figure_09": Product("Tip under a harmonic load", figure_09, ("validation",)),
    "figure_10": Product("Free response", figure_10, ("response-*-free",), conservative),
    "figure_11": Product("Augmented surrogate", figure_11),
    "figure_12": Product("Forced response", figure_12, ("response-*-forced",), conservative),
    "figure_13": Product("Total energy", figure_13, ("energy-*",), conservative),
    "figure_14": Product("Free response", figure_14, ("response-*-free",), damped),
    "figure_15": Product("Forced response", figure_15, ("response-*-forced",), damped),
    "energy_decay": Product("Total energy", energy_decay, ("energy-*",), damped),
    "architecture_errors": Product("Errors by architecture", architecture_errors, ("relatives",), damped),
    "cost_accuracy": Product("Cost against accuracy", cost_accuracy, ("cost-*-*",)),
    "training_loss": Product("Training loss against wall time", training_loss, ("history", "metrics")),
}

TABLES: dict[str, Product[pd.DataFrame]] = {
    "static_tip": Product("Tip under static loads", tables.static_tip, ("statics",)),
    "natural_frequencies": Product("Natural frequencies", tables.natural_frequencies, ("frequencies",)),
    "training": Product("Training runs", tables.training, ("metrics",)),
    "architectures": Product("Every architecture in every setting", architectures, ("metrics",)),
    "seeds": Product("Mean and spread over seeds", seeds, ("metrics",)),
    "cost": Product("Cost and accuracy", tables.cost, ("cost-*-*",)),
    "learned_loads": Product("Learned loads", tables.learned_loads, ("learned_loads-*",)),
}

__all__ = ["FIGURES", "TABLES", "Product", "damped", "save", "save_page", "save_table"]
