"""One look for every figure: sizes for print, colours that colour-blind readers can tell apart, saving."""

import re
from collections.abc import Callable, Iterable, Sequence
from functools import wraps
from pathlib import Path
from typing import Any, ParamSpec
from zlib import crc32

import matplotlib
import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.backends.backend_svg import FigureCanvasSVG
from matplotlib.colors import to_hex, to_rgb
from matplotlib.figure import Figure
from matplotlib.ticker import NullLocator
from numpy.typing import NDArray

from flexsurr.config.own_network import own_network
from flexsurr.storage import replacing

Inputs = ParamSpec("Inputs")
Array = NDArray[np.float64]
"""That of `simulation.rhs`, which brings along a compiler that takes half a second."""

COLUMN_IN = 3.5
PAGE_IN = 7.2
"""Widths [in] of one column and of a page of a journal."""

PNG_DPI = 200

# Okabe and Ito, "Color universal design", 2008. One colour a model, the same in every figure.
BLACK, ORANGE, SKY, GREEN = "#000000", "#E69F00", "#56B4E9", "#009E73"
BLUE, VERMILION, PURPLE, GREY = "#0072B2", "#D55E00", "#CC79A7", "#7F7F7F"
COLOURS: dict[str, str] = {
    "reference": BLACK,
    "data": BLACK,
    "exact": "#A8A8A8",
    "rom": BLACK,
    "fom": ORANGE,
    "mlp": VERMILION,
    "hnn": BLUE,
    "polynomial": GREEN,
    "dissipative_hnn": PURPLE,
    "port_hamiltonian": SKY,
    "even_hnn": "#004C8C",
}
NAMES: dict[str, str] = {
    "reference": "reduced order",
    "data": "data",
    "exact": "exact",
    "rom": "reduced order",
    "fom": "full order",
    "mlp": "MLP",
    "hnn": "HNN",
    "polynomial": "polynomial H",
    "dissipative_hnn": "D-HNN",
    "port_hamiltonian": "port-Hamiltonian",
    "even_hnn": "even HNN",
}
DASHES: dict[str, Any] = {
    "mlp": (0, (4, 1.5)),
    "hnn": (0, (2.2, 1.1)),
    "polynomial": (0, (1, 1)),
    "dissipative_hnn": (0, (5, 1, 1, 1)),
    "port_hamiltonian": (0, (2.5, 2.5)),
    "even_hnn": (0, (1.5, 1.0)),
}
"""Line styles beside the colours, for those who print in black and white; solid where none is given."""

OWN_COLOURS = ("#8C510A", "#6A3D9A", "#666600", "#B2182B", "#01665E", "#C51B7D")
OWN_DASHES = ((0, (6, 2)), (0, (3, 1, 1, 1)), (0, (1.5, 1.5)), (0, (6, 1, 2, 1)), (0, (4, 3)))
"""Those of networks of the user's own, by a hash of their names: the same in every figure of every run."""

LOADED = "#F6E7C8"
"""The background where a load acts."""

VARIANTS: dict[str, str] = {
    "hamiltonian": "gyroscopic term kept",
    "as_printed": "gyroscopic term dropped, as printed",
    "files": "recorded data",
}


def colour(model: str) -> str:
    """The colour of a model; a pale one of its family where the name carries more, as in "hnn_paper"."""
    if own_network(model):
        return OWN_COLOURS[crc32(model.encode()) % len(OWN_COLOURS)]
    base = family(model)
    red, green, blue = to_rgb(COLOURS[base])
    share = 1.0 if model == base else 0.5
    return to_hex((1 - share + share * red, 1 - share + share * green, 1 - share + share * blue))


def label(model: str) -> str:
    """The model's name in legends, with what its name carries beyond the family in brackets.

    A network of the user's own, my_models.py:MyField, goes by its class.
    """
    if own := own_network(model):
        return own.name
    base = family(model)
    rest = model[len(base) :].strip("_ ")
    return f"{NAMES[base]} ({rest.replace('_', ' ')})" if rest else NAMES[base]


def dashes(model: str) -> Any:
    """The line style of a model."""
    if own_network(model):
        return OWN_DASHES[crc32(model.encode()) % len(OWN_DASHES)]
    return DASHES.get(family(model), "-")


def has_family(model: str) -> bool:
    """Whether a model has a colour and a name of its own here."""
    return bool(own_network(model)) or any(model == name or model.startswith(f"{name}_") for name in COLOURS)


def family(model: str) -> str:
    """The name that says a model's colour and line style; KeyError for a model of none."""
    if own_network(model):
        return model
    families = [name for name in COLOURS if model == name or model.startswith(f"{name}_")]
    if not families:
        raise KeyError(f"no colour for the model {model!r}: one of {', '.join(COLOURS)}")
    return max(families, key=len)


STYLE: dict[str, Any] = {
    "font.family": "DejaVu Sans",
    "font.size": 7.5,
    "mathtext.fontset": "dejavusans",
    "axes.titlesize": 8,
    "axes.titlelocation": "left",
    "axes.labelsize": 7.5,
    "axes.linewidth": 0.6,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "axes.axisbelow": True,
    "grid.color": "#E4E4E4",
    "grid.linewidth": 0.5,
    "xtick.labelsize": 7,
    "ytick.labelsize": 7,
    "xtick.major.width": 0.6,
    "ytick.major.width": 0.6,
    "xtick.minor.width": 0.4,
    "ytick.minor.width": 0.4,
    "legend.fontsize": 7,
    "legend.frameon": False,
    "legend.handlelength": 2.2,
    "lines.linewidth": 1.1,
    "lines.markersize": 4,
    "figure.dpi": 100,
    "savefig.dpi": PNG_DPI,
    "figure.constrained_layout.use": True,
    # glyphs as paths: the same picture on every machine, whatever fonts it has
    "svg.fonttype": "path",
    "svg.hashsalt": "flexsurr",
    "path.simplify_threshold": 0.2,
}


def styled(draw: Callable[Inputs, Figure]) -> Callable[Inputs, Figure]:
    """Run a figure function under the house style, whatever the caller's settings are."""

    @wraps(draw)
    def drawn(*args: Inputs.args, **kwargs: Inputs.kwargs) -> Figure:
        with matplotlib.rc_context():
            matplotlib.rcdefaults()
            matplotlib.rcParams.update(STYLE)
            return draw(*args, **kwargs)

    return drawn


def new_figure(width_in: float, height_in: float) -> Figure:
    """An empty figure on its own Agg canvas: no window, no global state."""
    figure = Figure(figsize=(width_in, height_in))
    FigureCanvasAgg(figure)
    return figure


def logarithmic(ax: Axes, x: bool = False, y: bool = False) -> None:
    """Logarithmic scales with ticks at decades only: the figures span too many to divide them."""
    if x:
        ax.set_xscale("log")
        ax.xaxis.set_minor_locator(NullLocator())
    if y:
        ax.set_yscale("log")
        ax.yaxis.set_minor_locator(NullLocator())


def fitting_legend(figure: Figure, handles: Sequence[Artist], loc: str) -> None:
    """A legend of the whole figure, outside its axes, in as few rows as fit its width."""
    for columns in range(len(handles), 0, -1):
        legend = figure.legend(handles=handles, loc=loc, ncols=columns)
        # measured, not drawn: to lay a whole figure out for each try takes seconds
        if legend.get_window_extent().width <= figure.bbox.width or columns == 1:
            return
        legend.remove()


def letter(axes: Iterable[Axes]) -> None:
    """(a), (b), … in front of the titles of `axes`."""
    for name, ax in zip("abcdefghijkl", axes, strict=False):
        title = ax.get_title(loc="left")
        ax.set_title(f"({name})  {title}" if title else f"({name})", loc="left")


def save(figure: Figure, stem: Path) -> tuple[Path, Path]:
    """Write `stem`.svg and `stem`.png, each there whole or not at all; return both paths.

    The bytes depend on the figure alone: no date, no version, no random identifiers.
    """
    svg, png = (stem.with_name(f"{stem.name}{ending}") for ending in (".svg", ".png"))
    with matplotlib.rc_context():
        matplotlib.rcParams.update(STYLE)
        figure.dpi = PNG_DPI
        # The canvases themselves, for `Figure.savefig` draws twice, and lays out anew for each format.
        with replacing(svg) as beside:
            FigureCanvasSVG(figure).print_svg(beside, metadata={"Date": None, "Creator": None})
        figure.set_layout_engine("none")
        figure.dpi = PNG_DPI  # an SVG is written in points
        with replacing(png) as beside:
            FigureCanvasAgg(figure).print_png(beside, metadata={"Software": None})
    return svg, png


INTEGRATOR_NAMES: dict[str, str] = {
    "scipy_radau": "SciPy Radau",
    "scipy_bdf": "SciPy BDF",
    "scipy_lsoda": "SciPy LSODA",
    "scipy_rk45": "SciPy RK45",
    "scipy_dop853": "SciPy DOP853",
    "rk4": "RK4",
    "dop853_fixed": "order 8, fixed",
    "dop853": "DOP853",
    "gauss_legendre_4": "Gauss–Legendre 4",
    "gauss_legendre_6": "Gauss–Legendre 6",
    "radau_iia_5": "Radau IIA 5",
}
_SCIPY = (0, (1, 1))
_INTEGRATOR_LINES: dict[str, tuple[str, Any]] = {
    "scipy_radau": (VERMILION, _SCIPY),
    "scipy_bdf": (GREY, _SCIPY),
    "scipy_lsoda": (PURPLE, _SCIPY),
    "scipy_rk45": (ORANGE, _SCIPY),
    "scipy_dop853": (SKY, _SCIPY),
    "rk4": (ORANGE, "-"),
    "dop853_fixed": (BLUE, "-"),
    "dop853": (SKY, "-"),
    "gauss_legendre_4": (GREY, "-"),
    "gauss_legendre_6": (BLACK, "-"),
    "radau_iia_5": (VERMILION, "-"),
}


def integrator_method(text: str) -> str:
    """The method of an integrator's label, e.g. "rk4" of "rk4(h=0.001)"."""
    return text.split("(", 1)[0]


def integrator_name(text: str) -> str:
    """The label in words, with its step or relative tolerance; SciPy's defaults without."""
    method = integrator_method(text)
    name = INTEGRATOR_NAMES.get(method, method)
    setting = re.search(r"(h|rtol)=([-+.0-9e]+)", text)
    if setting is None:
        return name
    value = f"{float(setting[2]):g}".replace("e-0", "e-")
    return f"{name}, h = {value} s" if setting[1] == "h" else f"{name}, rtol {value}"


def integrator_colour(text: str) -> tuple[str, Any]:
    """Colour and line style; SciPy's are dotted. Labels of one method share them."""
    return _INTEGRATOR_LINES.get(integrator_method(text), (GREY, "-"))
