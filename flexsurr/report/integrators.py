"""How integrators are named and told apart in figures. Their labels are those of the tables."""

import re
from typing import Any

from flexsurr.report.style import BLACK, BLUE, GREY, ORANGE, PURPLE, SKY, VERMILION

NAMES: dict[str, str] = {
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
_LINES: dict[str, tuple[str, Any]] = {
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
    name = NAMES.get(method, method)
    setting = re.search(r"(h|rtol)=([-+.0-9e]+)", text)
    if setting is None:
        return name
    value = f"{float(setting[2]):g}".replace("e-0", "e-")
    return f"{name}, h = {value} s" if setting[1] == "h" else f"{name}, rtol {value}"


def integrator_colour(text: str) -> tuple[str, Any]:
    """Colour and line style; SciPy's are dotted. Labels of one method share them."""
    return _LINES.get(integrator_method(text), (GREY, "-"))
