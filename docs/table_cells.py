"""How the tables of the documents are written: as Markdown, with numbers to the digits that count."""

import math
from collections.abc import Iterable, Sequence


def markdown(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A table of text."""
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)


def rounded(value: float, digits: int = 2) -> str:
    """`value` to so many digits that count; nothing where there is none."""
    if not math.isfinite(value):
        return ""
    if value == 0.0 or 1e-3 <= abs(value) < 1e6:
        places = digits - 1 - math.floor(math.log10(abs(value))) if value else 0
        return f"{round(value, places):,.{max(places, 0)}f}"
    return f"{value:.{digits - 1}e}".replace("e-0", "e-")


def percent(value: float, digits: int = 2) -> str:
    """A part of something."""
    return f"{rounded(value, digits)} %" if math.isfinite(value) else ""


def seconds(value: float, digits: int = 3, spread: float = math.nan) -> str:
    """A time in the unit that suits it, with its spread if it has one."""
    if not math.isfinite(value):
        return ""
    units = ((1.0, "s"), (1e3, "ms"), (1e6, "µs"), (1e9, "ns"))
    scale, unit = next(((s, u) for s, u in units if value * s >= 1.0), units[-1])
    known = f" ± {rounded(spread * scale, 1)}" if math.isfinite(spread) else ""
    return f"{rounded(value * scale, digits)}{known} {unit}"
