"""Write what results/tables/benchmarks.csv holds into docs/speed.md.

    python benchmarks/table.py [results/tables/benchmarks.csv]

What stands between the two marks is replaced; the words around it stay.
"""

import sys
from pathlib import Path

import pandas as pd

DOCUMENT = Path(__file__).parents[1] / "docs/speed.md"
BEGIN, END = "<!-- measured -->", "<!-- end of what was measured -->"


def seconds(row: pd.Series) -> str:
    scale, unit = next(
        (s, u) for s, u in ((1, "s"), (1e3, "ms"), (1e6, "µs"), (1e9, "ns")) if row.median_s * s >= 1
    )
    return f"{row.median_s * scale:.3g} ± {row.spread_s * scale:.1g} {unit}"


def section(what: str, rows: pd.DataFrame) -> str:
    """The table of what was timed in turns."""
    lines = [
        f"**{what[0].upper()}{what[1:]}** (`benchmarks/{rows['benchmark'].iloc[0]}.py`)",
        "",
        f"| | one call | of {rows['against'].iloc[0]} |",
        "|---|---|---|",
    ]
    for row in rows.itertuples():
        spread = "" if row.case == row.against else f" ± {row.ratio_spread:.1g}"
        lines.append(f"| {row.case} | {seconds(row)} | {row.ratio:.3g}{spread} |")
    return "\n".join(lines)


def measured(table: pd.DataFrame) -> str:
    """All sections, after a line that says where they were measured."""
    machine = table.iloc[0]
    versions = ", ".join(f"{name} {machine[name]}" for name in ("python", "numpy", "numba", "scipy", "torch"))
    head = (
        f"{machine['processor']}, {machine['cores']} cores; {versions}; commit {str(machine['commit'])[:7]}."
    )
    groups = table.groupby(["benchmark", "what"], sort=False)
    return "\n\n".join([head, *(section(what, rows) for (_, what), rows in groups)])


def main() -> None:
    table = pd.read_csv(sys.argv[1] if len(sys.argv) > 1 else "results/tables/benchmarks.csv")
    before, rest = DOCUMENT.read_text(encoding="utf-8").split(BEGIN)
    after = rest.split(END)[1]
    DOCUMENT.write_text(f"{before}{BEGIN}\n\n{measured(table)}\n\n{END}{after}", encoding="utf-8")


if __name__ == "__main__":
    main()
