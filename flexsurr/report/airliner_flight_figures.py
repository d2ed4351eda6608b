"""The airliner in flight, lattice against network: eigenvalues and doublets (Figs. 18 to 21 of the study)."""

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from flexsurr.config.flight import DoubletTimes
from flexsurr.report.style import BLACK, BLUE, GREY, LOADED, ORANGE, PAGE_IN, letter, new_figure, styled

LABELS: dict[str, str] = {
    "u_m_s": "u [m/s]",
    "v_m_s": "v [m/s]",
    "w_m_s": "w [m/s]",
    "p_deg_s": "roll rate p [°/s]",
    "q_deg_s": "pitch rate q [°/s]",
    "r_deg_s": "yaw rate r [°/s]",
    "phi_deg": "roll angle φ [°]",
    "theta_deg": "pitch angle θ [°]",
    "psi_deg": "yaw angle ψ [°]",
    "altitude_m": "altitude h [m]",
    "north_m": "position x [m]",
    "east_m": "position y [m]",
}
LONGITUDINAL = ("u_m_s", "w_m_s", "q_deg_s", "theta_deg", "altitude_m", "north_m")
LATERAL = ("v_m_s", "phi_deg", "p_deg_s", "r_deg_s", "psi_deg", "east_m")
# What both do in a quantity that does not move: no percentage of its peak means anything.
_STILL = 1e-3
_PANELS_IN_TWO_COLUMNS = 6
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
def figure_19(doublets: pd.DataFrame, doublet: DoubletTimes) -> Figure:
    """Elevator doublet, longitudinal states: u, w, q, θ, h, x, lattice against network.

    `doublets`: for the models "vlm_frozen" and "network" the outputs over time after each control's doublet,
    columns model, control, t_s and those shown.
    """
    return _histories(doublets, "elevator", LONGITUDINAL, doublet)


@styled
def figure_20(doublets: pd.DataFrame, doublet: DoubletTimes) -> Figure:
    """The same elevator doublet, lateral-directional states: v, φ, p, r, ψ, y. As `figure_19`."""
    return _histories(doublets, "elevator", LATERAL, doublet)


@styled
def figure_21(doublets: pd.DataFrame, doublet: DoubletTimes, elastic: pd.DataFrame) -> Figure:
    """The same elevator doublet, displacements of the modes that the aerodynamics knows. As `figure_19`.

    `elastic`: `flexsurr.evaluation.airliner_modes.elastic_modes`, which names the modes.
    """
    known = elastic[elastic["in_aerodynamics"]]
    return _histories(doublets, "elevator", _etas(known), doublet, known)


@styled
def aileron_doublet(doublets: pd.DataFrame, doublet: DoubletTimes, elastic: pd.DataFrame) -> Figure:
    """Aileron doublet: lateral-directional states and antisymmetric modes. As `figure_21`."""
    return _lateral(doublets, "aileron", doublet, elastic)


@styled
def rudder_doublet(doublets: pd.DataFrame, doublet: DoubletTimes, elastic: pd.DataFrame) -> Figure:
    """Rudder doublet: lateral-directional states and antisymmetric modes. As `figure_21`."""
    return _lateral(doublets, "rudder", doublet, elastic)


def _lateral(doublets: pd.DataFrame, control: str, doublet: DoubletTimes, elastic: pd.DataFrame) -> Figure:
    known = elastic[elastic["in_aerodynamics"] & ~elastic["symmetric"]]
    return _histories(doublets, control, (*LATERAL, *_etas(known)), doublet, known)


def _etas(elastic: pd.DataFrame) -> tuple[str, ...]:
    return tuple(f"eta_{k}" for k in elastic["mode"])


def _histories(
    doublets: pd.DataFrame,
    control: str,
    shown: tuple[str, ...],
    doublet: DoubletTimes,
    elastic: pd.DataFrame | None = None,
) -> Figure:
    flown = doublets[doublets["control"] == control]
    lattice, network = (flown[flown["model"] == model] for model in ("vlm_frozen", "network"))
    names: dict[str, str] = {}
    if elastic is not None:
        names = dict(zip(_etas(elastic), elastic["name"].astype(str), strict=True))
    columns = 2 if len(shown) <= _PANELS_IN_TWO_COLUMNS else 3
    rows = -(-len(shown) // columns)
    figure = new_figure(PAGE_IN, 1.75 * rows + 0.3)
    grid = figure.subplots(rows, columns, sharex=True).ravel()
    for ax, name in zip(grid, shown, strict=False):
        ax.axvspan(doublet.start_s, doublet.middle_s, color=LOADED, linewidth=0, zorder=0)
        ax.axvspan(doublet.middle_s, doublet.end_s, color=LOADED, alpha=0.5, linewidth=0, zorder=0)
        ax.plot(lattice["t_s"], lattice[name], color=BLACK, linewidth=1.6)
        ax.plot(network["t_s"], network[name], color=ORANGE, linewidth=1.0, linestyle=(0, (3, 2)))
        ax.set_ylabel(LABELS.get(name, rf"$\eta_{{{name.removeprefix('eta_')}}}$ [kg$^{{1/2}}$ m]"))
        ax.set_xlim(0.0, float(lattice["t_s"].max()))
        said = (names.get(name, ""), _difference(lattice[name].to_numpy(), network[name].to_numpy()))
        ax.set_title("\n".join(text for text in said if text), loc="left")
    for ax in grid[len(shown) :]:
        ax.set_visible(False)
    for ax in grid[max(len(shown) - columns, 0) : len(shown)]:
        ax.set_xlabel("time [s]")
        ax.tick_params(labelbottom=True)
    handles = [Line2D([], [], color=BLACK, linewidth=1.6, label="vortex lattice")]
    if len(network):
        handles.append(Line2D([], [], color=ORANGE, linestyle=(0, (3, 2)), label="network"))
    figure.legend(handles=handles, loc="outside upper center", ncols=2)
    letter(grid[: len(shown)])
    return figure


def _difference(lattice: np.ndarray, network: np.ndarray) -> str:
    """The largest difference, in percent of the lattice's peak if it moves at all; "" if a flight ended."""
    if len(lattice) != len(network):
        return ""
    difference, peak = float(np.abs(network - lattice).max()), float(np.abs(lattice - lattice[0]).max())
    if peak <= _STILL * difference:
        return f"lattice {peak:.0e}, network {difference:.0e} at most"
    return f"off by {100.0 * difference / peak:.2g} % of the peak" if peak > 0.0 else ""


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
