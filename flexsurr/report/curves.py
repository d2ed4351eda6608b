"""Curves of many models against time: how each is drawn, which of them the paper shows, and the legend."""

from collections.abc import Iterable, Sequence

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from flexsurr.report.style import LOADED, VARIANTS, colour, dashes, family, label

PAPERS_SWEEP = "paper"
"""A sweep of this name holds the paper's own recipe; its networks have the name added to their own."""

SHOWN_BEYOND = 0.25
"""How far beyond the reference's range the axes go, as a share of it: a model that leaves it is cut off."""

TRUTHS = ("reference", "rom")

PAPERS_LINES = ("-", (0, (3.0, 2.0)))


def variants_in(frame: pd.DataFrame) -> list[str]:
    """The variants that have rows, in the order of every figure."""
    return [variant for variant in VARIANTS if variant in set(frame["variant"])]


def each(frame: pd.DataFrame, column: str = "model") -> Sequence[tuple[str, pd.DataFrame]]:
    """The rows of each value of a column, in order of appearance."""
    return [(str(value), part) for value, part in frame.groupby(column, sort=False)]


def the_papers(frame: pd.DataFrame, architectures: Iterable[str]) -> pd.DataFrame:
    """The rows of the reference and of one network of each of `architectures`, in that order.

    The network is that of the sweep `paper`, or else that of the sweep `default`; none where neither has one.
    """
    there = set(frame["model"])
    shown = [model for model in TRUTHS if model in there]
    for name in architectures:
        shown += [model for model in (f"{name}_{PAPERS_SWEEP}", name) if model in there][:1]
    return pd.concat([frame[frame["model"] == model] for model in shown])


def curve(ax: Axes, t: pd.Series, values: pd.Series, model: str) -> None:
    """One model's line; that of the reference is wide and pale, so that those on it are seen."""
    truth = model in TRUTHS
    ax.plot(
        t,
        values,
        color=colour(model),
        linestyle="-" if truth else dashes(model),
        linewidth=2.2 if truth else 1.0,
        alpha=0.35 if truth else 1.0,
        label=label(model),
        zorder=2 if truth else 3,
    )


def papers_curves(ax: Axes, shown: pd.DataFrame, quantity: str) -> None:
    """A column of `the_papers` rows against time: the first network solid, the second dashed on top of it."""
    networks = 0
    for model, part in each(shown):
        if model in TRUTHS:
            curve(ax, part["t_s"], part[quantity], model)
            continue
        ax.plot(
            part["t_s"],
            part[quantity],
            color=colour(family(model)),
            linestyle=PAPERS_LINES[networks],
            linewidth=1.0,
            label=label(model),
            zorder=3 + networks,
        )
        networks += 1


def follow_reference(ax: Axes, values: pd.Series) -> None:
    """Limits by the reference's `values`, and some more: another model may leave them."""
    low, high = float(values.min()), float(values.max())
    beyond = SHOWN_BEYOND * max(high - low, 1e-6)
    ax.set_ylim(low - beyond, high + beyond)


def shade(ax: Axes, load_end_s: float) -> None:
    """The interval in which the load acts, as far as there are curves: a load may have no end."""
    if load_end_s > 0.0:
        end_s = ax.dataLim.x1 if ax.lines else ax.get_xlim()[1]
        ax.axvspan(0.0, min(load_end_s, end_s), color=LOADED, linewidth=0, zorder=0)


def legend(figure: Figure, axes: Iterable[Axes], shaded: bool) -> None:
    """Every model that is drawn in any of `axes`, once, above the figure."""
    found = {name: line for ax in axes for line, name in zip(*ax.get_legend_handles_labels(), strict=True)}
    handles, names = list(found.values()), list(found)
    if shaded:
        handles, names = [*handles, Patch(color=LOADED)], [*names, "load acts"]
    figure.legend(handles, names, loc="outside upper center", ncols=min(len(names), 5))
