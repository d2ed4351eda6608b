"""One response of one surrogate, for who simulates it from Python or from the command line."""

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from flexsurr.report.response_figures import LABELS
from flexsurr.report.style import PAGE_IN, new_figure, styled


@styled
def response_plot(response: pd.DataFrame, title: str) -> Figure:
    """Tip and twist over time, those that move, or every state where there is no tip.

    `response`: columns t_s and either tip_x_m, tip_y_m, tip_z_m, tip_twist_rad or states by their names.
    """
    if "tip_x_m" in response:
        shown = response.assign(tip_twist_deg=np.rad2deg(np.unwrap(response["tip_twist_rad"])))[list(LABELS)]
        shown = shown.loc[:, shown.max() - shown.min() > 0.0] if len(shown) > 1 else shown
    else:
        shown = response.drop(columns=["t_s", "energy_J"], errors="ignore")
    figure = new_figure(PAGE_IN, 0.7 + 1.5 * shown.shape[1])
    axes = figure.subplots(shown.shape[1], 1, sharex=True, squeeze=False)[:, 0]
    for ax, name in zip(axes, shown, strict=True):
        ax.plot(response["t_s"], shown[name])
        ax.set_ylabel(LABELS.get(str(name), str(name)))
        ax.margins(x=0.0)
    axes[0].set_title(title, loc="left")
    axes[-1].set_xlabel("time [s]")
    return figure
