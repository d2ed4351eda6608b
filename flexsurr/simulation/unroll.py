"""Write `unrolled.py`: Runge–Kutta methods with their stages unrolled.

A loop over a tableau costs three times as much as its stages written out, because zero coefficients
are multiplied and the compiler cannot see across stages. Numba keeps machine code on disk only for
functions that stand in a file, so the file is written once, by

    python -m flexsurr.simulation.unroll

and kept with the sources; a test compares it with what this module writes.
"""

from collections.abc import Iterable
from math import prod
from pathlib import Path

from flexsurr.simulation.tableaus import (
    DOP853,
    GAUSS_LEGENDRE_4,
    GAUSS_LEGENDRE_6,
    RK4,
    EmbeddedTableau,
    ExplicitTableau,
    ImplicitTableau,
    Row,
)

DESTINATION = Path(__file__).with_name("unrolled.py")

_HEAD = '''"""Runge–Kutta methods, stages unrolled. Written by unroll.py: do not edit.

All of them: kernel, time t [s], step h [s], state x (d,), stages k (stages, d), scratch y (d,), the
kernel's workspace, and the number d as a constant. Explicit methods find f(t, x) in the first row of k.
"""

# ruff: noqa: E501 (one sum of a tableau's row is one line)
# fmt: off
from numba import njit

from flexsurr.simulation.dimension import ORDERED, states
from flexsurr.simulation.rhs import rhs
'''

# Without reference counts, which functions that do not allocate can spare: they cost more than the sums.
_DECORATOR = '@njit(error_model="numpy", fastmath=ORDERED, _nrt=False)'
_EXACT = '@njit(error_model="numpy", _nrt=False)'
# What names no kernel is compiled once for all of them.
_KEPT = '@njit(cache=True, error_model="numpy", fastmath=ORDERED, _nrt=False)'
# A step is put into its caller, where it is seen which rows are which: only then are its sums vectorised.
_INLINED = '@njit(error_model="numpy", fastmath=ORDERED, _nrt=False, forceinline=True)'
_KEPT_INLINED = '@njit(cache=True, error_model="numpy", fastmath=ORDERED, _nrt=False, forceinline=True)'


def _sum(row: Row, scale: str = "") -> str:
    """Σ_j row_j k_j[i] as source, each term preceded by its sign; `scale` multiplies the coefficients.

    The step multiplies coefficients, not stages, since those products are ready before the newest stage.
    """
    opening, closing = (f"({scale} * ", ")") if scale else ("", "")
    return "".join(
        f" {'-' if value < 0 else '+'} {opening}{abs(value)!r}{closing} * k{j}[i]" for j, value in row.items()
    )


def _function(name: str, arguments: str, docstring: str, body: list[str], decorator: str = _DECORATOR) -> str:
    lines = [
        decorator,
        f"def {name}({arguments}):",
        f'    """{docstring}"""',
        *(f"    {line}" for line in body),
    ]
    return "\n".join(lines) + "\n"


def _names(rows: range | list[int]) -> list[str]:
    return ["d = states(constant, x)", *(f"k{j} = k[{j}]" for j in rows)]


def _sums(name: str, rows: Iterable[Row]) -> list[str]:
    """Of each row x + h Σ_j row_j k_j, as functions `name`_0, `name`_1, …"""
    return [
        _function(
            f"{name}_{number}",
            "h, x, k, y, constant",
            "Write x and a sum of stages into y, which may be x.",
            [*_names(list(row)), "for i in range(d):", f"    y[i] = x[i]{_sum(row, 'h')}"],
            _KEPT_INLINED,
        )
        for number, row in enumerate(rows)
    ]


def _stages(sums: str, nodes: Iterable[float], first: int) -> list[str]:
    """Evaluate at `nodes` the stages whose states are `sums`, numbered from `first`."""
    lines = []
    for number, node in enumerate(nodes):
        lines += [
            f"{sums}_{number}(h, x, k, y, constant)",
            f"rhs(kernel, t + {node!r} * h, y, k[{first + number}], work)",
        ]
    return lines


def _step(name: str, tableau: ExplicitTableau) -> list[str]:
    stages = len(tableau.c)
    body = [
        *_stages(name, tableau.c[1:], first=1),
        f"{name}_{stages - 1}(h, x, k, x_new, constant)",
    ]
    step = _function(
        name,
        "kernel, t, h, x, x_new, k, y, work, constant",
        "Write the state at t + h into x_new, which may be x.",
        body,
        _INLINED,
    )
    return [*_sums(name, [*tableau.a[1:], tableau.b]), step]


def _error(name: str, tableau: EmbeddedTableau) -> str:
    used = sorted({*tableau.error_3, *tableau.error_5})
    body = [
        *_names(used),
        "square_3 = 0.0",
        "square_5 = 0.0",
        "for i in range(d):",
        "    scale = 1.0 / (atol + rtol * max(abs(x[i]), abs(x_new[i])))",
        f"    error_3 = scale * ({_sum(tableau.error_3)})",
        f"    error_5 = scale * ({_sum(tableau.error_5)})",
        "    square_3 += error_3 * error_3",
        "    square_5 += error_5 * error_5",
        "return square_3, square_5",
    ]
    return _function(
        name,
        "x, x_new, k, rtol, atol, constant",
        "Sums of squares of the two error estimates over h, scaled.",
        body,
        _KEPT,
    )


def _dense(name: str, tableau: EmbeddedTableau) -> list[str]:
    end = len(tableau.method.c)
    rows = [
        "dense[0, i] = x_new[i] - x[i]",
        "dense[1, i] = h * k0[i] - dense[0, i]",
        f"dense[2, i] = 2.0 * dense[0, i] - h * (k{end}[i] + k0[i])",
        *(f"dense[{3 + n}, i] = h * ({_sum(row)})" for n, row in enumerate(tableau.dense)),
    ]
    coefficients = _function(
        f"{name}_coefficients",
        "h, x, x_new, dense, k, constant",
        "Write the dense output's coefficients (7, d) from all stages.",
        [
            *_names(sorted({0, end}.union(*tableau.dense))),
            "for i in range(d):",
            *(f"    {row}" for row in rows),
        ],
        _KEPT,
    )
    stages = _function(
        name,
        "kernel, t, h, x, x_new, dense, k, y, work, constant",
        f"Write the dense output's coefficients (7, d); k[{end}] holds f at the end of the step.",
        [
            *_stages(name, tableau.further.c, first=end + 1),
            f"{name}_coefficients(h, x, x_new, dense, k, constant)",
        ],
    )
    return [*_sums(name, tableau.further.a), coefficients, stages]


def _extrapolation(tableau: ImplicitTableau) -> list[Row]:
    """Weights that continue the polynomial through a step's stages to those of the next step."""
    rows = []
    for node in tableau.c:
        row = {}
        for j, own in enumerate(tableau.c):
            others = [c for n, c in enumerate(tableau.c) if n != j]
            row[j] = prod(1.0 + node - c for c in others) / prod(own - c for c in others)
        rows.append(row)
    return rows


def _extrapolate(name: str, tableau: ImplicitTableau) -> str:
    count = len(tableau.c)
    body = [
        *_names(range(count)),
        "for i in range(d):",
        *(f"    new{s} ={_sum(row)}" for s, row in enumerate(_extrapolation(tableau))),
        *(f"    k{s}[i] = new{s}" for s in range(count)),
    ]
    return _function(
        name, "x, k, constant", "Replace the last step's stages by a guess of the next's.", body, _KEPT
    )


def _sweep(name: str, tableau: ImplicitTableau) -> str:
    body = [*_names(range(len(tableau.c))), "largest = 0.0", "poison = 0.0"]
    for number, (node, row) in enumerate(zip(tableau.c, tableau.a, strict=True)):
        body += [
            "for i in range(d):",
            f"    y[i] = x[i]{_sum(row, 'h')}",
            f"rhs(kernel, t + {node!r} * h, y, new, work)",
            "for i in range(d):",
            f"    change = h * abs(new[i] - k{number}[i])",
            "    scale = abs(x[i]) + h * abs(new[i])",
            "    if change > largest * scale:",
            "        largest = change / scale",
            "    poison += 0.0 * change",
            f"    k{number}[i] = new[i]",
        ]
    body.append("return largest + poison")
    return _function(
        name,
        "kernel, t, h, x, k, y, new, work, constant",
        "Evaluate each stage from the newest others; the largest change relative to the state, or NaN.",
        body,
    )


def _increment(name: str, tableau: ImplicitTableau) -> str:
    body = [
        *_names(range(len(tableau.c))),
        "for i in range(d):",
        f"    total = lost[i]{_sum(tableau.b, 'h')}",
        "    before = x[i]",
        "    x[i] = before + total",
        "    lost[i] = (before - x[i]) + total",
    ]
    return _function(
        name,
        "h, x, k, lost, constant",
        "Add the step to x and keep what rounding loses for the next (Kahan's summation).",
        body,
        _EXACT,
    )


def _collocation(name: str, tableau: ImplicitTableau) -> list[str]:
    return [
        _extrapolate(f"{name}_extrapolate", tableau),
        _sweep(f"{name}_sweep", tableau),
        _increment(f"{name}_increment", tableau),
    ]


def source() -> str:
    """The text of `unrolled.py`."""
    return "\n\n".join(
        [
            _HEAD,
            *_step("rk4_step", RK4),
            *_step("dop853_step", DOP853.method),
            _error("dop853_error", DOP853),
            *_dense("dop853_dense", DOP853),
            *_collocation("gauss_legendre_4", GAUSS_LEGENDRE_4),
            *_collocation("gauss_legendre_6", GAUSS_LEGENDRE_6),
        ]
    )


if __name__ == "__main__":
    DESTINATION.write_text(source(), encoding="utf-8")
