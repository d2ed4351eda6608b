"""Every trial of a study by what it costs and what it errs: where a dearer surrogate is worth it."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from flexsurr.evaluation.selection import COST, ERROR, NMSE, choose
from flexsurr.report.labels import Point, freeze_layout, place_labels
from flexsurr.report.style import (
    BLACK,
    BLUE,
    GREEN,
    GREY,
    NAMES,
    ORANGE,
    PAGE_IN,
    PURPLE,
    VARIANTS,
    VERMILION,
    colour,
    fitting_legend,
    label,
    letter,
    logarithmic,
    new_figure,
    styled,
)

REFERENCES = {
    "rom_operations": (f"{NAMES['rom']}, compiled", BLACK),
    "fom_operations": (f"{NAMES['fom']}, compiled", ORANGE),
    "vlm_rebuild": ("lattice, rebuilt", ORANGE),
    "vlm_frozen": ("lattice, frozen", BLACK),
    "vlm_frozen_one_mach": ("lattice, frozen at one Mach number", BLACK),
    "quadratic": ("lattice, quadratic form", GREEN),
}
"""What one right-hand side of the compiled reference models takes, and one call of the lattice's forms."""

FRONT = "#C9C9C9"
FRONT_POINTS = 3.0
"""How wide the line of what nothing beats is [points]."""

LEAST = 1e-9
"""Errors [%] of less are rounding, and are drawn there."""

MAPS = {"network": BLUE, "quadratic": GREEN, "linear": PURPLE}
POLYNOMIAL, NETWORK = "s", "o"
"""Markers: squares are found by least squares, discs trained."""

RULE: dict[str, Any] = {"color": VERMILION, "linewidth": 0.8, "linestyle": (0, (4, 2))}
RING: dict[str, Any] = {
    "color": BLACK,
    "marker": "o",
    "markersize": 9,
    "markerfacecolor": "none",
    "linestyle": "",
}

SETTINGS = ("hidden", "activation", "terms", "mass_matrix", "networks", "inputs")
USUAL = ("all", "factored", "one", "features")
"""Values that go without saying."""


@dataclass(frozen=True)
class _Rule:
    """By which error trials are placed and chosen, what the axis calls it, and how large it may be."""

    error: str
    axis: str
    at_most: float | None

    @property
    def in_words(self) -> str:
        limit = f"{self.at_most:g}".replace("e-0", "e-")
        return f"{limit}{' %' if self.error == ERROR else ''}: the rule of choice"


@styled
def pareto(
    selection: Mapping[str, Any], lattice_operations: Mapping[str, int] | None, metrics: pd.DataFrame
) -> Figure:
    """The operations of one evaluation of every trial against its error, and which is chosen.

    `metrics`: a row for each run, of which `operations` and the worst error of long responses (of a map, the
    validation nmse) are shown; `selection`: the study's rule of choice; `lattice_operations`: what each form
    of the lattice takes which maps stand for. One panel for each variant of a field. The grey line joins what
    nothing beats in both; a ring is around the one that the rule chooses, dashed the largest error that it
    allows. Named are those, and what it chooses of each architecture. Upright lines are the compiled
    reference models. Runs that diverged, or that call Python, have no place.
    """
    metrics = metrics.assign(**(lattice_operations or {}))
    metrics = metrics.reindex(columns=list(dict.fromkeys([*metrics, COST, ERROR, *REFERENCES])))
    variants = [variant for variant in VARIANTS if variant in set(metrics["variant"])]
    if variants:
        limit = selection.get("error_at_most_percent")
        rule = _Rule(ERROR, "worst error of long responses [%]", limit)
    else:
        rule = _Rule(NMSE, "validation nmse [–]", selection.get("nmse_at_most"))
    panels = [(VARIANTS[variant], metrics[metrics["variant"] == variant]) for variant in variants]
    figure = new_figure(PAGE_IN, 0.9 + 3.0 * max(len(panels), 1))
    axes = figure.subplots(max(len(panels), 1), 1, sharex=True, sharey=True, squeeze=False)[:, 0]
    shown = [(title, _with_a_place(part, rule.error)) for title, part in panels or [("", metrics)]]
    for ax, (title, _) in zip(axes, shown, strict=True):
        logarithmic(ax, x=True, y=True)
        ax.set_title(title, loc="left")
        ax.set_ylabel(rule.axis)
    axes[-1].set_xlabel("operations of one evaluation [–]")
    _limits(axes[0], pd.concat([part for _, part in shown]), rule)
    _legend(figure, pd.concat([part for _, part in shown]), rule)
    letter(axes if len(axes) > 1 else [])
    freeze_layout(figure)
    for ax, (_, part) in zip(axes, shown, strict=True):
        _panel(ax, part, rule)
    return figure


def front(trials: pd.DataFrame, error: str = ERROR) -> pd.DataFrame:
    """The trials that no other beats in both operations and error, cheapest first."""
    ordered = trials.sort_values([COST, error, "run_id"])
    return ordered[ordered[error] < ordered[error].cummin().shift(fill_value=np.inf)]


def _with_a_place(trials: pd.DataFrame, error: str) -> pd.DataFrame:
    kept = trials[(trials["status"] == "finished") & trials[COST].notna() & trials[error].notna()]
    if "diverged" in kept:
        kept = kept[~(kept["diverged"] > 0)]
    return kept.assign(**{COST: kept[COST].astype(float), error: kept[error].astype(float).clip(lower=LEAST)})


def _panel(ax: Axes, trials: pd.DataFrame, rule: _Rule) -> None:
    error, drawn = rule.error, []
    if rule.at_most:
        drawn.append(ax.axhline(rule.at_most, **RULE, zorder=1))
    for column, (title, shade) in REFERENCES.items():
        for operations in trials[column].dropna().unique()[:1]:
            drawn.append(ax.axvline(operations, color=shade, linewidth=0.8, zorder=1))
            _stand(ax, operations, title, shade)
    best = front(trials, error)
    drawn += ax.step(best[COST], best[error], where="post", color=FRONT, linewidth=FRONT_POINTS, zorder=1)
    for (architecture, marker), part in _kinds(trials):
        ax.plot(part[COST], part[error], marker, color=_shade(architecture), markersize=4.2, zorder=3)
    named = best
    if len(trials):
        parts = [trials, *(part for _, part in _kinds(trials))]
        chosen, *of_each = (_chosen(part, rule) for part in parts)
        ax.plot(chosen[COST], chosen[error], **RING, zorder=4)
        named = pd.concat([best, *of_each]).drop_duplicates("run_id")
    place_labels(
        ax,
        list(zip(named[COST], named[error], strict=True)),
        _settings(named),
        [_shade(architecture) for architecture in named["architecture"]],
        obstacles=[*zip(trials[COST], trials[error], strict=True), *_along(ax, drawn)],
    )


def _stand(ax: Axes, operations: float, title: str, shade: str) -> None:
    """Write the title of a reference model along its line."""
    ax.annotate(
        title,
        (operations, 0.98),
        xycoords=("data", "axes fraction"),
        xytext=(-2, 0),
        textcoords="offset points",
        rotation=90,
        ha="right",
        va="top",
        fontsize=6,
        color=shade,
    )


def _along(ax: Axes, lines: Sequence[Line2D]) -> Iterator[Point]:
    """Points of these lines, in data coordinates, a few pixels apart."""
    for line in lines:
        corners = line.get_transform().transform(line.get_path().vertices)
        for start, end in pairwise(corners):
            count = 1 + int(np.hypot(*(end - start)) // 4.0)
            pixels = start + np.linspace(0.0, 1.0, count)[:, None] * (end - start)
            yield from map(tuple, ax.transData.inverted().transform(pixels))


def _kinds(trials: pd.DataFrame) -> Iterator[tuple[tuple[str, str], pd.DataFrame]]:
    """The trials of each architecture and marker."""
    markers = trials["optimiser"].map(lambda name: POLYNOMIAL if name == "least_squares" else NETWORK)
    for (architecture, marker), part in trials.groupby(["architecture", markers], sort=False):
        yield (str(architecture), str(marker)), part


def _chosen(trials: pd.DataFrame, rule: _Rule) -> pd.DataFrame:
    """The row of the trial that the rule chooses."""
    columns = trials[["run_id", COST, rule.error]]
    runs = {str(row.iloc[0]): {str(name): row[name] for name in row.index} for _, row in columns.iterrows()}
    return trials[(trials["run_id"] == choose(runs, rule.at_most, rule.error)).to_numpy()]


def _settings(trials: pd.DataFrame) -> list[str]:
    """Each trial in a few words: its architecture, size and form; its data where others have the same."""
    words = [_words(trial) for _, trial in trials.iterrows()]
    return [
        f"{text}, {dataset}" if words.count(text) > 1 else text
        for text, dataset in zip(words, trials["dataset"], strict=True)
    ]


def _words(trial: "pd.Series[Any]") -> str:
    found = [_name(str(trial["architecture"]))]
    if not _missing(trial.get("degree")):
        found.append(f"degree {trial['degree']:.0f}")
    found += [str(trial[key]) for key in SETTINGS if not _missing(trial.get(key)) and trial[key] not in USUAL]
    return " ".join(found).replace("_", " ")


def _shade(architecture: str) -> str:
    return MAPS.get(architecture) or colour(architecture)


def _name(architecture: str) -> str:
    return architecture if architecture in MAPS else label(architecture)


def _missing(value: Any) -> bool:
    return value is None or value == "" or value != value


def _limits(ax: Axes, trials: pd.DataFrame, rule: _Rule) -> None:
    """Limits that hold every point and line, and leave room for labels; shared by all panels."""
    costs = pd.concat([trials[column] for column in (COST, *REFERENCES)]).dropna().astype(float)
    errors = [*trials[rule.error], *([rule.at_most] if rule.at_most else [])]
    if costs.empty:
        return
    ax.set_xlim(costs.min() / 2.0, costs.max() * 2.0)
    ax.set_ylim(min(errors) / 10.0, max(errors) * 4.0)


def _legend(figure: Figure, trials: pd.DataFrame, rule: _Rule) -> None:
    kinds = [kind for kind, _ in _kinds(trials)]
    of_one = [architecture for architecture, _ in kinds]
    handles = []
    for architecture, marker in kinds:
        name = _name(architecture)
        if of_one.count(architecture) > 1:
            name += ", polynomial" if marker == POLYNOMIAL else ", network"
        handles.append(Line2D([], [], color=_shade(architecture), marker=marker, linestyle="", label=name))
    handles.append(Line2D([], [], color=FRONT, linewidth=FRONT_POINTS, label="nothing beats these in both"))
    if len(trials):
        handles.append(Line2D([], [], **RING, label="chosen"))
    if rule.at_most:
        handles.append(Line2D([], [], **RULE, label=rule.in_words))
    fitting_legend(figure, handles or [Line2D([], [], color=GREY)], "outside upper center")
