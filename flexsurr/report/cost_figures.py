"""Cost against accuracy, with every model and every baseline in one picture."""

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from flexsurr.report.labels import freeze_layout, place_labels
from flexsurr.report.style import (
    NAMES,
    PAGE_IN,
    VARIANTS,
    colour,
    family,
    fitting_legend,
    integrator_method,
    label,
    letter,
    logarithmic,
    new_figure,
    styled,
)

MARKERS: dict[str, str] = {"described": "s", "numpy": "D", "compiled": "o", "torch": "^"}

SHORT: dict[str, str] = {
    "scipy_radau": "SciPy",
    "rk4": "RK4",
    "dop853_fixed": "order 8",
    "dop853": "DOP853",
    "gauss_legendre_4": "GL4",
    "gauss_legendre_6": "GL6",
    "radau_iia_5": "Radau IIA",
}

RESPONSES = ("free", "forced")

WORTH_NAMING_PERCENT = 5.0
"""Errors up to which a point of the Pareto front gets a label: cheap and wrong is no bargain."""


@styled
def cost_accuracy(cost: pd.DataFrame) -> Figure:
    """Wall time of one response against its tip error: every model × implementation × integrator.

    `cost`: the columns of cost.csv. One row of panels for each response, one column for each
    variant. Labelled: the useful part of the Pareto front, the baselines and torch. A setup of which
    a simulation diverged is hollow; one of which all did has no place.
    """
    responses = [response for response in RESPONSES if response in set(cost["response"])]
    variants = [variant for variant in VARIANTS if variant in set(cost["variant"])]
    figure = new_figure(PAGE_IN, 0.7 + 0.05 * cost["model"].nunique() + 3.1 * len(responses))
    grid = figure.subplots(len(responses), len(variants), sharex=True, sharey=True, squeeze=False)
    for row, response in zip(grid, responses, strict=True):
        for ax, variant in zip(row, variants, strict=True):
            logarithmic(ax, x=True, y=True)
            ax.set_title(f"{response} response, {VARIANTS[variant]}", loc="left")
        row[0].set_ylabel("largest tip error [% of the peak]")
    for ax in grid[-1]:
        ax.set_xlabel("wall time of one response [s]")
    _legend(figure, cost)
    _limits(grid[0, 0], cost)
    letter(grid.ravel())
    freeze_layout(figure)
    for row, response in zip(grid, responses, strict=True):
        for ax, variant in zip(row, variants, strict=True):
            _panel(ax, cost[(cost["response"] == response) & (cost["variant"] == variant)])
    return figure


def pareto_front(cost: pd.DataFrame) -> pd.DataFrame:
    """The rows that no other row beats in both wall time and tip error, cheapest first."""
    finite = cost.dropna(subset=["wall_s_mean", "tip_error_percent"]).sort_values(
        ["wall_s_mean", "tip_error_percent"]
    )
    before = finite["tip_error_percent"].cummin().shift(fill_value=np.inf)
    return finite[finite["tip_error_percent"] < before]


def _panel(ax: Axes, cost: pd.DataFrame) -> None:
    front = pareto_front(cost)
    ax.step(
        front["wall_s_mean"],
        front["tip_error_percent"],
        where="post",
        color="#C9C9C9",
        linewidth=3.0,
        zorder=1,
    )
    top = ax.get_ylim()[1]
    points, labels = [], []
    for setup, of_front in zip(cost.to_dict("records"), cost.index.isin(front.index), strict=True):
        model, implementation, method = (
            str(setup["model"]),
            str(setup["implementation"]),
            integrator_method(str(setup["integrator"])),
        )
        wall_s, error = float(setup["wall_s_mean"]), float(setup["tip_error_percent"])
        if not np.isfinite(wall_s):
            continue
        point = (wall_s, error if np.isfinite(error) else top)
        points.append(point)
        ax.plot(
            *point,
            MARKERS[implementation],
            color=colour(model),
            markersize=4.2,
            markeredgewidth=0.8,
            markerfacecolor="none" if setup["diverged"] else None,
            zorder=3,
            clip_on=False,
        )
        way = implementation if method == "scipy_radau" else SHORT.get(method, method)
        name = label(model).replace(NAMES["rom"], "ROM")
        if (of_front and error <= WORTH_NAMING_PERCENT) or _is_landmark(model, implementation, method):
            labels.append((point, f"{name}, {way}", colour(family(model))))
        elif model == "rom":
            # surrogates stand at the same heights or to their left: one model names the integrators
            labels.append((point, way, colour(model)))
    _published(ax, cost)
    place_labels(
        ax,
        [at for at, _, _ in labels],
        [text for _, text, _ in labels],
        [shade for _, _, shade in labels],
        obstacles=points,
    )


def _is_landmark(model: str, implementation: str, method: str) -> bool:
    """The baselines, and networks in torch: labelled wherever they lie."""
    return implementation in ("described", "torch") or (model == "rom" and method == "scipy_radau")


def _published(ax: Axes, cost: pd.DataFrame) -> None:
    """The study's own ratios, as wall times beside our described reduced model, with their spread."""
    described = cost[(cost["model"] == "rom") & (cost["implementation"] == "described")]["wall_s_mean"]
    published = cost[cost["paper_percent"].notna()].drop_duplicates("model").sort_values("paper_percent")
    if described.empty:
        return
    second_of = float(described.iloc[0]) / 100.0
    for k, (_, row) in enumerate(published.iterrows()):
        mean, spread = float(row["paper_percent"]), float(row["paper_std_percent"])
        shade = colour(family(row["model"]))
        ax.axvspan((mean - spread) * second_of, (mean + spread) * second_of, color=shade, alpha=0.1, zorder=0)
        ax.axvline(mean * second_of, color=shade, linewidth=0.8, linestyle=(0, (4, 2)), zorder=0)
        ax.annotate(
            f"published {label(row['model'])}, {mean:g} ± {spread:g} %",
            (mean * second_of, 0.45),
            xycoords=("data", "axes fraction"),
            xytext=(2 if k else -2, 0),
            textcoords="offset points",
            ha="left" if k else "right",
            va="center",
            rotation=90,
            fontsize=6,
            color=shade,
        )


def _limits(ax: Axes, cost: pd.DataFrame) -> None:
    """Limits that hold every point and leave room for labels; shared by all panels."""
    wall, error = cost["wall_s_mean"].dropna(), cost["tip_error_percent"].dropna()
    ax.set_xlim(wall.min() / 3.0, wall.max() * 6.0)
    ax.set_ylim(max(error[error > 0.0].min(), 1e-12) / 4.0, error.max() * 4.0)


def _in_legend(model: str) -> str:
    return f"{label(model)} (ROM)" if model == "rom" else label(model)


def _legend(figure: Figure, cost: pd.DataFrame) -> None:
    handles = [
        Line2D([], [], color=colour(model), marker="o", linestyle="", label=_in_legend(model))
        for model in dict.fromkeys(cost["model"])
    ]
    handles += [
        Line2D([], [], color="#555555", marker=marker, linestyle="", label=name)
        for name, marker in MARKERS.items()
        if name in set(cost["implementation"])
    ]
    handles.append(Line2D([], [], color="#C9C9C9", linewidth=3.0, label="Pareto front"))
    fitting_legend(figure, handles, "outside upper center")
