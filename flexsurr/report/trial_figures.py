"""Every trial of a study as a line through its settings to its error: parallel coordinates."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from textwrap import fill
from typing import Any

import matplotlib
import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.colors import Colormap, ListedColormap, LogNorm
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator

from flexsurr.config.own_network import own_network
from flexsurr.report.style import (
    GREY,
    NAMES,
    PAGE_IN,
    VARIANTS,
    VERMILION,
    label,
    letter,
    new_figure,
    styled,
)
from flexsurr.report.training_figures import OPTIMISERS
from flexsurr.report.trial_settings import FEW, as_text, follow_from, settings_that_differ

WITHOUT = 1.14
"""The height at which lines end that have no error, on axes from 0 to 1."""

BAND = 0.05
"""Half the height over which the lines of one choice are spread, at most."""

LABELS = 12
"""Most choices of an axis that are written."""

LONGEST = 28
CHARACTERS = 120
"""Of a choice in words, and of all axes side by side."""

MANY = 400
"""More lines are pixels in the SVG too, which would hold a path for each."""

ERROR = "validation nmse"


@dataclass(frozen=True)
class _Axis:
    """One setting: its name, the height of each trial (trials,), what is written where."""

    name: str
    heights: Any
    ticks: Mapping[float, str]


@styled
def trials(runs: Mapping[str, Sequence[str]], metrics: pd.DataFrame) -> Figure:
    """A line for each trial through the settings in which trials differ, to its validation nmse.

    `runs` has the run_ids of each sweep, `metrics` a row for each run. One panel for each variant of a
    field, one for all samples of maps. Few numbers, and words, are choices at equal distances; more numbers
    are a scale, logarithmic over a decade or more. Dark lines validated best, the thick one best of all
    in its panel; a trial that was stopped or failed ends above the scale.
    """
    metrics = metrics.assign(sweep=metrics["run_id"].map({key: name for name in runs for key in runs[name]}))
    variants = [variant for variant in VARIANTS if variant in set(metrics["variant"])]
    panels = [(VARIANTS[variant], metrics["variant"] == variant) for variant in variants] or [
        ("", pd.Series(True, index=metrics.index))
    ]
    settings = settings_that_differ(metrics)
    if metrics["sweep"].nunique() > 1:
        settings.insert(1, "sweep", metrics["sweep"])
        if "dataset" in settings and follow_from(settings, ["sweep"], "dataset"):
            settings = settings.drop(columns="dataset")
    figure = new_figure(PAGE_IN, 0.5 + 2.9 * len(panels))
    axes = figure.subplots(len(panels), 1, squeeze=False)[:, 0]
    for ax, (title, chosen) in zip(axes, panels, strict=True):
        _panel(ax, settings[chosen], metrics[chosen])
        ax.set_title(title, loc="left")
    figure.legend(handles=_handles(metrics), loc="outside lower center", ncols=5)
    letter(axes if len(axes) > 1 else [])
    return figure


def _panel(ax: Axes, settings: pd.DataFrame, metrics: pd.DataFrame) -> None:
    finished = (metrics["status"] == "finished").to_numpy()
    errors = metrics["validation_nmse"].astype(float).where(finished).clip(lower=1e-300).to_numpy()
    order = np.argsort(np.argsort(np.where(finished, errors, np.inf), kind="stable"))
    lines = [_axis(name, settings[name], order) for name in map(str, settings)]
    known = errors[finished]
    last = _scale(ERROR, errors) if known.size else _Axis(ERROR, errors, {})
    lines.append(last)
    heights = np.column_stack([axis.heights for axis in lines])
    heights[~finished, -1] = WITHOUT
    shades = _shades(errors, finished)
    # the best last, on top of all others
    for trial in np.argsort(-order):
        status = metrics["status"].iloc[trial]
        ax.plot(
            range(len(lines)),
            heights[trial],
            color=shades[trial] if finished[trial] else {"stopped": VERMILION}.get(status, GREY),
            linestyle="-" if finished[trial] else _UNFINISHED.get(status, ":"),
            linewidth=2.4 if finished[trial] and order[trial] == 0 else 0.9,
            alpha=0.95 if finished[trial] else 0.8,
            zorder=3 + (len(order) - order[trial]) / len(order),
            solid_joinstyle="round",
            rasterized=len(order) > MANY,
        )
    room = max(7, CHARACTERS // len(lines))
    head = 1.03 if finished.all() else WITHOUT + 0.05
    for place, axis in enumerate(lines):
        _draw(ax, place, axis, room, at_the_right=place == len(lines) - 1)
        # every other one higher, where one beside the other has no room
        is_higher = place % 2 and any(len(axis.name) > room for axis in lines)
        name = fill(axis.name, room, break_long_words=False)
        at = head + (0.11 if is_higher else 0.0)
        ax.text(place, at, name, fontsize=6.5, fontweight="bold", ha="center", va="bottom")
    if not finished.all():
        ax.text(len(lines) - 1 + 0.06, WITHOUT, "none", fontsize=6, va="center", color="#555555")
    ax.set(xlim=(-0.75, len(lines) - 0.5), ylim=(-0.02, head + 0.2))
    ax.grid(False)
    ax.set_xticks([])
    ax.set_yticks([])
    ax.spines[["left", "bottom"]].set_visible(False)


_UNFINISHED = {"stopped": (0, (4, 2)), "failed": (0, (1, 1.5))}


def _draw(ax: Axes, place: int, axis: _Axis, room: int, at_the_right: bool) -> None:
    """The axis, and its values beside it in lines of `room` characters."""
    ax.plot([place, place], [0.0, 1.0], color="#333333", linewidth=0.8, zorder=2)
    for height, text in axis.ticks.items():
        ax.plot([place - 0.025, place + 0.025], [height] * 2, color="#333333", linewidth=0.8, zorder=2)
        ax.text(
            place + (0.06 if at_the_right else -0.06),
            height,
            fill(text, room, break_long_words=False),
            fontsize=6,
            linespacing=0.95,
            ha="left" if at_the_right else "right",
            va="center",
            zorder=9,
            bbox={"facecolor": "white", "edgecolor": "none", "alpha": 0.75, "pad": 0.6},
        )


def _axis(name: str, values: "pd.Series[Any]", order: Any) -> _Axis:
    """A scale where there are many numbers, else choices."""
    title = name.replace("_", " ")
    if pd.api.types.is_numeric_dtype(values) and values.nunique() > FEW:
        return _scale(title, values.astype(float).to_numpy())
    choices = sorted(values.dropna().unique(), key=_by_size)
    nothing = ["–"] if values.isna().any() else []
    count = len(choices) + len(nothing)
    places = np.linspace(BAND, 1.0 - BAND, count) if count > 1 else np.array([0.5])
    rank = values.map({value: k + len(nothing) for k, value in enumerate(choices)}).fillna(0).astype(int)
    heights = places[rank.to_numpy()]
    band = min(BAND, 0.36 / count)
    for choice in range(count):  # side by side, the best lowest as on the axis of the error
        of_choice = np.flatnonzero(rank.to_numpy() == choice)
        if of_choice.size > 1:
            offsets = np.linspace(-band, band, of_choice.size)
            heights[of_choice[np.argsort(order[of_choice])]] += offsets
    is_numbers = pd.api.types.is_numeric_dtype(values)
    written = _different(choices) if is_numbers else [_word(name, value) for value in choices]
    words = [*nothing, *written]
    every = -(-count // LABELS)
    return _Axis(title, heights, dict(list(zip(places.tolist(), words, strict=True))[::every]))


def _by_size(value: Any) -> tuple[Any, ...]:
    """Numbers by size, layers (16x16) by their numbers of neurons, words by the alphabet."""
    if not isinstance(value, str):
        return (0, value)
    layers = value.split("x")
    return (1, [int(width) for width in layers]) if all(map(str.isdigit, layers)) else (2, value)


def _scale(name: str, values: Any) -> _Axis:
    """Numbers by their size, or by its logarithm; those that are missing stand below."""
    known = values[np.isfinite(values)]
    low, high = float(known.min()), float(known.max())
    floor = 0.14 if name != ERROR and np.isnan(values).any() else 0.0
    is_log = low > 0.0 and high / low >= 10.0
    if is_log:
        first, last = np.log10(low), np.log10(high)
        ticks = _decades(first, last)
    else:
        first, last = low, high
        ticks = [tick for tick in MaxNLocator(5).tick_values(low, high) if low <= tick <= high]
    if last == first:
        first, last = first - 0.5, last + 0.5
        ticks = [low]

    def height(value: Any) -> Any:
        at = np.log10(value) if is_log else np.asarray(value)
        return floor + (1.0 - floor) * (at - first) / (last - first)

    heights = np.where(np.isnan(values), 0.0, height(np.where(np.isnan(values), low, values)))
    written = dict(zip((float(height(tick)) for tick in ticks), _different(ticks), strict=True))
    return _Axis(name, heights, written | ({0.0: "–"} if floor else {}))


def _different(numbers: Sequence[float]) -> list[str]:
    """Numbers in as few digits as tell them apart, three or more; whole ones whole."""
    if all(number == int(number) and abs(number) < 1e6 for number in numbers):
        return [f"{number:.0f}" for number in numbers]
    for digits in range(3, 17):
        texts = [f"{number:.{digits}g}".replace("e-0", "e-").replace("e+0", "e+") for number in numbers]
        if len(set(texts)) == len(texts):
            break
    return texts


def _decades(first: float, last: float) -> list[float]:
    """Powers of ten between, at most six; the ends and what lies midway where there are none."""
    powers = np.arange(np.ceil(first), np.floor(last) + 1)
    if powers.size < 2:
        return [float(10.0**power) for power in np.linspace(first, last, 3)]
    return [float(f"1e{int(power)}") for power in powers[:: -(-powers.size // 6)]]


def _shades(errors: Any, finished: Any) -> Any:
    known = errors[finished]
    if known.size == 0:
        return [GREY] * errors.size
    low, high = known.min(), known.max()
    norm = LogNorm(low, high if high > low else 10.0 * low)
    return _dark_to_pale()(norm(np.where(finished, errors, high)))


def _dark_to_pale() -> Colormap:
    """From dark for the best; its palest shades, which nobody sees on white, are left out."""
    return ListedColormap(matplotlib.colormaps["viridis"](np.linspace(0.0, 0.88, 256)))


def _word(name: str, value: Any) -> str:
    """A choice as figures say it: architectures and optimisers by their names, others as they are written."""
    if name == "architecture" and (own_network(value) or any(str(value).startswith(each) for each in NAMES)):
        return label(value)
    if name == "optimiser":
        return OPTIMISERS[value][0].replace("–", "– ")
    text = as_text(value).replace("_", " ")
    return text if len(text) <= LONGEST else text[: LONGEST - 1] + "…"


def _handles(metrics: pd.DataFrame) -> list[Line2D]:
    shades = _dark_to_pale()
    handles = [
        Line2D([], [], color=shades(0.0), linewidth=2.4, label="best"),
        Line2D([], [], color=shades(0.3), linewidth=0.9, label="finished: the darker, the better"),
        Line2D([], [], color=shades(1.0), linewidth=0.9, label="worst that finished"),
    ]
    for status, shade in (("stopped", VERMILION), ("failed", GREY)):
        count = (metrics["status"] == status).sum()
        if count:
            dashes = _UNFINISHED[status]
            handles.append(Line2D([], [], color=shade, linestyle=dashes, label=f"{status} ({count})"))
    return handles
