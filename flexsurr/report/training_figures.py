"""Loss against wall time and against epochs, and a network's error against each of its inputs."""

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from flexsurr.report.style import (
    BLACK,
    BLUE,
    GREEN,
    GREY,
    ORANGE,
    PAGE_IN,
    PURPLE,
    SKY,
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
    "adamw_cosine": ("AdamW, cosine schedule", PURPLE),
    "adamw": ("AdamW", SKY),
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
    return _panels(history, metrics, "wall_s", "wall time of training [s]")


@styled
def training_epochs(history: pd.DataFrame, metrics: pd.DataFrame) -> Figure:
    """The same against epochs: passes over the samples, or steps of a method that uses all of them at once.

    A model found by least squares stands at the first.
    """
    return _panels(history, metrics.assign(epoch=1), "epoch", "epochs [–]")


def _panels(history: pd.DataFrame, metrics: pd.DataFrame, along: str, name: str) -> Figure:
    variants = [variant for variant in VARIANTS if variant in set(metrics["variant"])]
    solved = metrics["optimiser"] == "least_squares"
    architectures = list(dict.fromkeys(metrics[~solved]["architecture"])) or list(
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
                    _curves(ax, curves[run.run_id], along, str(run.optimiser))
            _points(ax, of_variant[of_variant["optimiser"] == "least_squares"], along)
            logarithmic(ax, x=True, y=True)
            ax.set_title(label(architecture), loc="left")
        row[0].set_ylabel(f"{VARIANTS[variant]}\nloss (nmse)")
    for ax in grid[-1]:
        ax.set_xlabel(name)
    optimisers = [optimiser for optimiser in OPTIMISERS if optimiser in set(metrics["optimiser"])]
    _legend(figure, grid[0, 0], optimisers, list(dict.fromkeys(metrics[solved]["architecture"])))
    letter(grid.ravel())
    return figure


def _curves(ax: Axes, curve: pd.DataFrame, along: str, optimiser: str) -> None:
    colour = OPTIMISERS[optimiser][1]
    curve = curve[curve[along] > 0.0]
    ax.plot(curve[along], curve["train_loss"], color=colour, linewidth=0.6, linestyle=(0, (1, 1)), alpha=0.8)
    ax.plot(curve[along], curve["validation_loss"], color=colour, linewidth=1.1, alpha=0.9)


def _points(ax: Axes, solved: pd.DataFrame, along: str) -> None:
    ax.plot(solved[along], solved["validation_nmse"], "D", color=OPTIMISERS["least_squares"][1], zorder=5)


def _legend(figure: Figure, ax: Axes, optimisers: list[str], solved: list[str]) -> None:
    handles, names = [], []
    by_least_squares = ", ".join(label(architecture) for architecture in solved)
    for optimiser in optimisers:
        name, colour = OPTIMISERS[optimiser]
        marker, line = ("D", "") if optimiser == "least_squares" else ("", "-")
        handles += ax.plot([], [], color=colour, marker=marker, linestyle=line)
        names.append(f"{by_least_squares}, {name}" if optimiser == "least_squares" else name)
    handles += ax.plot([], [], color="#555555", linestyle="-")
    handles += ax.plot([], [], color="#555555", linestyle=(0, (1, 1)), linewidth=0.6)
    figure.legend(handles, [*names, "validation", "training"], loc="outside upper center", ncols=4)


BINS = 8
ANGLES = ("alpha", "beta", "i_t", "delta_")
INPUT_LABELS: dict[str, str] = {
    "mach": "Mach number",
    "altitude_m": "altitude [km]",
    "alpha": "α [°]",
    "beta": "β [°]",
    "p_over_V": "p/V [rad/m]",
    "q_over_V": "q/V [rad/m]",
    "r_over_V": "r/V [rad/m]",
    "i_t": "tail incidence [°]",
    "delta_e_left": "left elevator [°]",
    "delta_e_right": "right elevator [°]",
    "delta_a_left": "left aileron [°]",
    "delta_a_right": "right aileron [°]",
    "delta_r": "rudder [°]",
}


@styled
def coefficient_errors(errors: pd.DataFrame) -> Figure:
    """Error of the network on held-out samples against each input, a panel an input.

    `errors`: a row a sample; columns named as the inputs, and `error_<output>` over that output's standard
    deviation. Dots: the largest error of any output at each sample. Line: the root mean square over all
    outputs in each of a few bins of equally many samples.
    """
    outputs = [name for name in errors.columns if name.startswith("error_")]
    inputs = [name for name in errors.columns if name not in outputs]
    percent = 100.0 * errors[outputs].abs().to_numpy()
    largest, squares = percent.max(axis=1), (percent**2).mean(axis=1)
    columns = 5
    rows = -(-len(inputs) // columns)
    figure = new_figure(PAGE_IN, 1.35 * rows + 0.4)
    grid = figure.subplots(rows, columns, sharey=True, squeeze=False)
    for ax, name in zip(grid.ravel(), inputs, strict=False):
        value = _input_shown(name, errors[name].to_numpy(dtype=float))
        ax.semilogy(value, largest, ".", color=GREY, markersize=1.5, alpha=0.6, rasterized=True)
        order = np.argsort(value)
        bins = np.array_split(order, min(BINS, len(order))) if len(order) else []
        middle = [value[members].mean() for members in bins]
        ax.semilogy(middle, [np.sqrt(squares[members].mean()) for members in bins], color=BLUE)
        ax.set_xlabel(_input_label(name))
    for ax in grid.ravel()[len(inputs) :]:
        ax.set_visible(False)
    if errors.empty:
        figure.suptitle("no network has finished")
    figure.supylabel("error [% of the output's standard deviation]", fontsize="medium")
    handles = [
        Line2D([], [], color=GREY, marker=".", linestyle="", label="worst output of a held-out sample"),
        Line2D([], [], color=BLUE, label="root mean square over the outputs"),
    ]
    figure.legend(handles=handles, loc="outside upper center", ncols=2)
    return figure


def _input_shown(name: str, value: np.ndarray) -> np.ndarray:
    if name.startswith(ANGLES):
        degrees: np.ndarray = np.degrees(value)
        return degrees
    return value / 1000.0 if name == "altitude_m" else value


def _input_label(name: str) -> str:
    if name.startswith("eta_dot_"):
        return rf"$\dot\eta_{name[8]}/V$ [kg$^{{1/2}}$]"
    if name.startswith("eta_"):
        return rf"$\eta_{name[4]}$ [kg$^{{1/2}}$ m]"
    return INPUT_LABELS.get(name, name)
