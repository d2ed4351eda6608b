"""The airliner in flight, lattice against network: eigenvalues and doublets (Figs. 18 to 21 of the study)."""

from collections.abc import Mapping

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from flexsurr.report.style import BLACK, BLUE, GREY, ORANGE, PAGE_IN, letter, new_figure, styled

LABELS: dict[str, str] = {
    "airspeed_m_s": "airspeed [m/s]",
    "alpha_deg": "angle of attack [°]",
    "theta_deg": "pitch angle [°]",
    "q_deg_s": "pitch rate [°/s]",
    "beta_deg": "sideslip [°]",
    "phi_deg": "bank angle [°]",
    "p_deg_s": "roll rate [°/s]",
    "r_deg_s": "yaw rate [°/s]",
    "altitude_m": "altitude [m]",
    "eta_1": r"$\eta_1$ [kg$^{1/2}$ m]",
    "eta_2": r"$\eta_2$ [kg$^{1/2}$ m]",
    "eta_5": r"$\eta_5$ [kg$^{1/2}$ m]",
    "eta_6": r"$\eta_6$ [kg$^{1/2}$ m]",
    "eta_7": r"$\eta_7$ [kg$^{1/2}$ m]",
}
ELEVATOR_SHOWN = ("airspeed_m_s", "alpha_deg", "theta_deg", "q_deg_s", "eta_1", "eta_5")
AILERON_SHOWN = ("beta_deg", "phi_deg", "p_deg_s", "r_deg_s", "eta_2", "eta_6")
RUDDER_SHOWN = ("beta_deg", "phi_deg", "p_deg_s", "r_deg_s", "eta_2", "eta_7")
_SHADE = "#F6E7C8"
_RIGID = ("short period", "phugoid", "dutch roll", "roll", "spiral")


@styled
def figure_18(modes: pd.DataFrame) -> Figure:
    """Eigenvalues of small motions in trim: all, and those near the origin.

    `modes`: columns mode, reference_real, reference_imag, surrogate_real, surrogate_imag [1/s].
    """
    figure = new_figure(PAGE_IN, 3.6)
    everything, near = figure.subplots(1, 2)
    rigid = modes[modes["mode"].isin(_RIGID)]
    for ax, shown, title in (
        (everything, modes, "all modes, upper half of the plane"),
        (near, rigid, "rigid-body modes"),
    ):
        ax.plot(
            shown["reference_real"],
            shown["reference_imag"],
            "o",
            color=BLACK,
            markerfacecolor="white",
            markersize=6,
        )
        ax.plot(shown["surrogate_real"], shown["surrogate_imag"], "x", color=BLUE, markersize=5)
        ax.set(xlabel="real part [1/s]", title=title)
        ax.axvline(0.0, color=GREY, linewidth=0.6)
        ax.margins(x=0.2, y=0.1)
    _name(everything, modes[~modes["mode"].isin(_RIGID)])
    _name(near, rigid)
    everything.set_ylabel("imaginary part [1/s]")
    handles = [
        Line2D(
            [], [], marker="o", linestyle="", color=BLACK, markerfacecolor="white", label="vortex lattice"
        ),
        Line2D([], [], marker="x", linestyle="", color=BLUE, label="network"),
    ]
    figure.legend(handles=handles, loc="outside upper center", ncols=2)
    letter((everything, near))
    return figure


@styled
def figure_19(flights: Mapping[str, pd.DataFrame], times_s: tuple[float, float, float]) -> Figure:
    """Elevator doublet: longitudinal outputs and two symmetric modes, lattice against network.

    `flights`: for "vlm_frozen" and "network" the outputs over time, columns t_s and those shown.
    """
    return _histories(flights, ELEVATOR_SHOWN, times_s)


@styled
def figure_20(flights: Mapping[str, pd.DataFrame], times_s: tuple[float, float, float]) -> Figure:
    """Aileron doublet: lateral outputs and two antisymmetric modes. As `figure_19`."""
    return _histories(flights, AILERON_SHOWN, times_s)


@styled
def figure_21(flights: Mapping[str, pd.DataFrame], times_s: tuple[float, float, float]) -> Figure:
    """Rudder doublet: lateral outputs and two antisymmetric modes. As `figure_19`."""
    return _histories(flights, RUDDER_SHOWN, times_s)


def _histories(
    flights: Mapping[str, pd.DataFrame], shown: tuple[str, ...], times_s: tuple[float, float, float]
) -> Figure:
    figure = new_figure(PAGE_IN, 5.4)
    grid = figure.subplots(3, 2, sharex=True)
    lattice, network = flights["vlm_frozen"], flights["network"]
    for ax, name in zip(grid.ravel(), shown, strict=True):
        ax.axvspan(times_s[0], times_s[1], color=_SHADE, linewidth=0, zorder=0)
        ax.axvspan(times_s[1], times_s[2], color=_SHADE, alpha=0.5, linewidth=0, zorder=0)
        ax.plot(lattice["t_s"], lattice[name], color=BLACK, linewidth=1.6)
        ax.plot(network["t_s"], network[name], color=ORANGE, linewidth=1.0, linestyle=(0, (3, 2)))
        ax.set_ylabel(LABELS[name])
        peak = float(np.abs(lattice[name] - lattice[name].iloc[0]).max())
        if peak > 0.0 and len(lattice) == len(network):
            error = 100.0 * float(np.abs(network[name].to_numpy() - lattice[name].to_numpy()).max()) / peak
            ax.set_title(f"largest difference {error:.2g} % of the peak", loc="left")
    for ax in grid[-1]:
        ax.set_xlabel("time [s]")
        ax.set_xlim(0.0, float(lattice["t_s"].max()))
    handles = [
        Line2D([], [], color=BLACK, linewidth=1.6, label="vortex lattice"),
        Line2D([], [], color=ORANGE, linestyle=(0, (3, 2)), label="network"),
    ]
    figure.legend(handles=handles, loc="outside upper center", ncols=2)
    letter(grid.ravel())
    return figure


def _name(ax: Axes, modes: pd.DataFrame) -> None:
    """The name of each mode beside its eigenvalue: on its left where another is close on its right."""
    x, y = modes["reference_real"].to_numpy(), modes["reference_imag"].to_numpy()
    width, height = np.ptp(x) or 1.0, np.ptp(y) or 1.0
    for name, x_here, y_here in zip(modes["mode"], x, y, strict=True):
        right, apart = (x - x_here) / width, np.abs(y - y_here) / height
        crowded = np.any((right > 0.0) & (right < 0.3) & (apart < 0.08))
        ax.annotate(
            str(name).removeprefix("elastic "),
            (x_here, y_here),
            xytext=(-7 if crowded else 7, 2),
            textcoords="offset points",
            horizontalalignment="right" if crowded else "left",
            fontsize=6.5,
            color=GREY,
        )
