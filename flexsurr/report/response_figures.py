"""Time histories of the paper's networks beside the model they stand for: Figs. 10, 12, 14 and 15."""

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from flexsurr.report.curves import follow_reference, legend, papers_curves, shade, the_papers, variants_in
from flexsurr.report.style import PAGE_IN, VARIANTS, letter, new_figure, styled

CANTILEVER_S = 2.0
"""What Figs. 10 and 12 show, by the paper's text."""

WING_S = 10.0
"""What our Figs. 14 and 15 show; the paper's text does not say what its own do."""

LABELS = {
    "tip_x_m": "tip x [m]",
    "tip_y_m": "tip y [m]",
    "tip_z_m": "tip z [m]",
    "tip_twist_deg": "tip twist [deg]",
}
CANTILEVERS_TIP = ("tip_x_m", "tip_z_m")


@styled
def figure_10(response: pd.DataFrame) -> Figure:
    """The first 2 s of a free response of the cantilever: tip x and z of reference, HNN and MLP.

    `response`: columns variant, model ("reference" or a surrogate's), t_s, tip_x_m, tip_y_m, tip_z_m,
    tip_twist_rad, load_end_s; one simulation a variant. One column of panels for each variant.
    """
    return _histories(response, ("hnn", "mlp"), CANTILEVERS_TIP, CANTILEVER_S)


@styled
def figure_12(response: pd.DataFrame) -> Figure:
    """The first 2 s under a load that acts throughout: as `figure_10`."""
    return _histories(response, ("hnn", "mlp"), CANTILEVERS_TIP, CANTILEVER_S)


@styled
def figure_14(response: pd.DataFrame) -> Figure:
    """A free response of the wing: tip x, y, z and twist of reference, D-HNN and MLP. As `figure_10`."""
    return _histories(response, ("dissipative_hnn", "mlp"), tuple(LABELS), WING_S)


@styled
def figure_15(response: pd.DataFrame) -> Figure:
    """The wing from rest under the loads of eqs. 13 and 14 for 5 s: as `figure_14`."""
    return _histories(response, ("dissipative_hnn", "mlp"), tuple(LABELS), WING_S)


def _histories(
    response: pd.DataFrame, architectures: tuple[str, ...], quantities: tuple[str, ...], until_s: float
) -> Figure:
    """One row of panels for each of `quantities`, one column for each variant, to `until_s` [s]."""
    variants = variants_in(response)
    response = response[response["t_s"] <= until_s]
    response = response.assign(tip_twist_deg=np.rad2deg(response["tip_twist_rad"]))
    figure = new_figure(PAGE_IN, 0.7 + 1.5 * len(quantities))
    grid = figure.subplots(len(quantities), len(variants), sharex=True, sharey="row", squeeze=False)
    for column, variant in zip(grid.T, variants, strict=True):
        shown = the_papers(response[response["variant"] == variant], architectures)
        load_end_s = min(float(shown["load_end_s"].max()), float(shown["t_s"].max()))
        for ax, quantity in zip(column, quantities, strict=True):
            papers_curves(ax, shown, quantity)
            shade(ax, load_end_s)
            ax.margins(x=0.0)
        column[0].set_title(VARIANTS[variant], loc="left")
        column[-1].set_xlabel("time [s]")
    for row, quantity in zip(grid, quantities, strict=True):
        row[0].set_ylabel(LABELS[quantity])
        follow_reference(row[0], response.loc[response["model"] == "reference", quantity])
    legend(figure, grid[0], shaded=bool((response["load_end_s"] > 0.0).any()))
    letter(grid.ravel())
    return figure
