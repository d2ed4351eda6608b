"""What training costs: loss against wall time."""

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from flexsurr.report.style import (
    BLACK,
    BLUE,
    GREEN,
    ORANGE,
    PAGE_IN,
    VARIANTS,
    VERMILION,
    label,
    letter,
    logarithmic,
    new_figure,
    styled,
)

OPTIMISERS: dict[str, tuple[str, str]] = {
    "levenberg_marquardt": ("Levenberg–Marquardt", BLUE),
    "lbfgs": ("L-BFGS", GREEN),
    "adam_cosine": ("Adam, cosine schedule", ORANGE),
    "adam": ("Adam", VERMILION),
    "least_squares": ("linear least squares", BLACK),
}


@styled
def training_loss(history: pd.DataFrame, metrics: pd.DataFrame) -> Figure:
    """Training and validation loss of every run against wall seconds, by architecture and optimiser.

    `history`: columns run_id, epoch, wall_s, train_loss, validation_loss. `metrics`: one row a run with
    run_id, variant, architecture, optimiser, wall_s, validation_nmse. One row of panels for each
    variant, one column for each architecture that is trained step by step; a model found in one step of
    least squares is a point in every panel of its variant, for comparison.
    """
    variants = [variant for variant in VARIANTS if variant in set(metrics["variant"])]
    stepwise = metrics[metrics["optimiser"] != "least_squares"]
    architectures = list(dict.fromkeys(stepwise["architecture"])) or list(
        dict.fromkeys(metrics["architecture"])
    )
    figure = new_figure(PAGE_IN, 0.6 + 2.25 * len(variants))
    grid = figure.subplots(len(variants), len(architectures), sharex=True, sharey=True, squeeze=False)
    curves = dict(list(history.groupby("run_id")))
    for row, variant in zip(grid, variants, strict=True):
        of_variant = metrics[metrics["variant"] == variant]
        for ax, architecture in zip(row, architectures, strict=True):
            for run in of_variant[of_variant["architecture"] == architecture].itertuples():
                if run.optimiser != "least_squares" and run.run_id in curves:
                    _curves(ax, curves[run.run_id], str(run.optimiser))
            _points(ax, of_variant[of_variant["optimiser"] == "least_squares"])
            logarithmic(ax, x=True, y=True)
            ax.set_title(f"{label(architecture)}, {VARIANTS[variant]}", loc="left")
        row[0].set_ylabel("loss (nmse)")
    for ax in grid[-1]:
        ax.set_xlabel("wall time of training [s]")
    _legend(figure, grid[0, 0], [o for o in OPTIMISERS if o in set(metrics["optimiser"])])
    letter(grid.ravel())
    return figure


def _curves(ax: Axes, curve: pd.DataFrame, optimiser: str) -> None:
    colour = OPTIMISERS[optimiser][1]
    curve = curve[curve["wall_s"] > 0.0]
    ax.plot(
        curve["wall_s"], curve["train_loss"], color=colour, linewidth=0.6, linestyle=(0, (1, 1)), alpha=0.8
    )
    ax.plot(curve["wall_s"], curve["validation_loss"], color=colour, linewidth=1.1, alpha=0.9)


def _points(ax: Axes, solved: pd.DataFrame) -> None:
    ax.plot(solved["wall_s"], solved["validation_nmse"], "D", color=OPTIMISERS["least_squares"][1], zorder=5)


def _legend(figure: Figure, ax: Axes, optimisers: list[str]) -> None:
    handles, names = [], []
    for optimiser in optimisers:
        name, colour = OPTIMISERS[optimiser]
        marker, line = ("D", "") if optimiser == "least_squares" else ("", "-")
        handles += ax.plot([], [], color=colour, marker=marker, linestyle=line)
        names.append("polynomial H, " + name if optimiser == "least_squares" else name)
    handles += ax.plot([], [], color="#555555", linestyle="-")
    handles += ax.plot([], [], color="#555555", linestyle=(0, (1, 1)), linewidth=0.6)
    figure.legend(handles, [*names, "validation", "training"], loc="outside upper center", ncols=4)
