"""The error of the airliner's network against each of its inputs."""

import numpy as np
import pandas as pd
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from flexsurr.report.style import BLUE, GREY, PAGE_IN, new_figure, styled

BINS = 8
ANGLES = ("alpha", "beta", "i_t", "delta_")
LABELS: dict[str, str] = {
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
        value = _shown(name, errors[name].to_numpy(dtype=float))
        ax.semilogy(value, largest, ".", color=GREY, markersize=1.5, alpha=0.6, rasterized=True)
        order = np.argsort(value)
        bins = np.array_split(order, min(BINS, len(order))) if len(order) else []
        middle = [value[members].mean() for members in bins]
        ax.semilogy(middle, [np.sqrt(squares[members].mean()) for members in bins], color=BLUE)
        ax.set_xlabel(_label(name))
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


def _shown(name: str, value: np.ndarray) -> np.ndarray:
    if name.startswith(ANGLES):
        degrees: np.ndarray = np.degrees(value)
        return degrees
    return value / 1000.0 if name == "altitude_m" else value


def _label(name: str) -> str:
    if name.startswith("eta_dot_"):
        return rf"$\dot\eta_{name[8]}/V$ [kg$^{{1/2}}$]"
    if name.startswith("eta_"):
        return rf"$\eta_{name[4]}$ [kg$^{{1/2}}$ m]"
    return LABELS.get(name, name)
