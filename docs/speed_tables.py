"""The tables of speed, each from results/tables/benchmarks.csv alone: see tables.py."""

from collections.abc import Callable, Iterator
from errno import ENOENT
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from table_cells import markdown, percent, rounded, seconds

SIDE_BY_SIDE = ("integrators", "chosen", "aerodynamics", "wing_surrogates")
"""The benchmarks that docs/speed.md shows row by row, beside those of peers; the file has every one."""
WHERE = ["processor", "cores", "python", "numpy", "numba", "scipy", "torch", "commit"]
EQUAL_ERROR = ("peers_of_the_beam",)
"""What is compared at equal errors: each code runs with several steps."""
OURS = "flexsurr"
FOLLOWS = 0.1
"""A run that errs by more does not follow the response at all."""
APART = 4.0
"""Runs whose errors are further apart than by this factor are not compared."""
GOALS = (
    ("cantilever, N = 10: chosen 8 times as fast", "30 s of the cantilever, N = 10", "chosen", 8.0),
    ("its network 4 times", "30 s of the cantilever, N = 10", "of the networks", 4.0),
    ("N = 160: chosen 40 times", "30 s of the cantilever, N = 160", "chosen", 40.0),
    ("wing, N = 16: chosen 3 times", "30 s of the wing, N = 16", "chosen", 3.0),
    ("N = 160: chosen 15 times", "30 s of the wing, N = 160", "chosen", 15.0),
)
ENSEMBLE = r"10000 responses of (?P<model>.+), step (?P<step>[\d.]+) s"


def _rows(results: Path, *subjects: str) -> pd.DataFrame:
    """What these benchmarks have kept, or all. Raises FileNotFoundError where there is none."""
    path = results / "tables/benchmarks.csv"
    table = pd.read_csv(path)
    if subjects:
        table = table[table["subject"].isin(subjects)]
    if table.empty:
        raise FileNotFoundError(ENOENT, "not measured", f"{', '.join(subjects)} in {path}")
    return table


def side_by_side(results: Path) -> str:
    """What `make benchmark` timed that a reader asks for first, after a line that says where."""
    table = _rows(results)
    table = table[table["subject"].isin(SIDE_BY_SIDE) | table["subject"].str.startswith("peers_")]
    groups = table.groupby(["subject", "work"], sort=False)
    return "\n\n".join([_where(table), *(_in_turns(what, rows) for (_, what), rows in groups)])


def _where(table: pd.DataFrame) -> str:
    """Machine, versions and commit; of each benchmark, where they are not the same for all."""
    lines = []
    groups = table.groupby(WHERE, sort=False)
    for place, rows in groups:
        of = dict(zip(WHERE, place, strict=True))
        versions = ", ".join(f"{name} {of[name]}" for name in WHERE[2:-1])
        commit = of["commit"][:7] + ("+" if of["commit"].endswith("+") else "")
        subjects = f"{', '.join(rows['subject'].unique())}: " if len(groups) > 1 else ""
        lines.append(f"{subjects}{of['processor']}, {of['cores']} cores; {versions}; commit {commit}.")
    return "\n\n".join(lines)


def _in_turns(work: str, rows: pd.DataFrame) -> str:
    """The table of what was timed in turns, or run once, with errors where they are known."""
    ours, subject = rows["ours"].iloc[0], rows["subject"].iloc[0]
    known = {
        "error": rows["error_peer"] * 100.0,
        **{name: rows[name] for name in ("energy_drift", "nmse") if name in rows},
    }
    known = {name: column for name, column in known.items() if column.notna().any()}
    cells = [
        (
            row.peer,
            seconds(row.peer_s, spread=row.peer_spread_s) or "not reached",
            _ratio(row),
            *(
                percent(c[row.Index]) if name == "error" else rounded(c[row.Index])
                for name, c in known.items()
            ),
        )
        for row in rows.itertuples()
    ]
    head = ("", "time", f"of {ours}", *(name.replace("_", " ") for name in known))
    return f"**{work[0].upper()}{work[1:]}** (`benchmarks/{subject}.py`)\n\n{markdown(head, cells)}"


def _ratio(row: Any) -> str:
    spread = "" if row.peer == row.ours or pd.isna(row.ratio_spread) else f" ± {rounded(row.ratio_spread, 1)}"
    return rounded(row.ratio, 3) + spread


def equal_errors(results: Path) -> str:
    """Each run of another code beside that of ours whose error is nearest, and the other way round.

    A code that has no run near any of ours has none here.
    """
    rows = [
        (work, code, _run(theirs, code), _run(ours, OURS), rounded(theirs.peer_s / ours.peer_s))
        for work, code, pairs in _pairs(_rows(results, *EQUAL_ERROR))
        for ours, theirs in pairs
    ]
    return markdown(("", "code", "its error and time", "ours", "times as long"), _once(rows, 2))


def _once(rows: list[tuple[str, ...]], columns: int) -> list[tuple[str, ...]]:
    """The rows, their first columns said once where they stay."""
    before = [("",) * columns, *(row[:columns] for row in rows)]
    return [
        (*("" if cell == last else cell for cell, last in zip(row, old, strict=False)), *row[columns:])
        for row, old in zip(rows, before, strict=False)
    ]


def _run(row: Any, code: str) -> str:
    settings = row.peer.removeprefix(code).lstrip(", ")
    return f"{row.error_peer:.1e} in {seconds(row.peer_s)}, {settings}".replace("e-0", "e-")


def _pairs(table: pd.DataFrame) -> Iterator[tuple[str, str, list[tuple[Any, Any]]]]:
    """Of each work and code the pairs of runs, ours first, that are nearest in error to one another.

    Of either side those alone that no other run of the same code beats in time and in error.
    """
    for work, rows in table[table["error_peer"] < FOLLOWS].groupby("work", sort=False):
        codes = rows["peer"].str.split(",").str[0]
        fronts = {code: _front(of) for code, of in rows.groupby(codes, sort=False)}
        ours = fronts.pop(OURS)
        for code, theirs in fronts.items():
            apart = np.abs(
                np.subtract.outer(*(np.log([r.error_peer for r in side]) for side in (ours, theirs)))
            )
            found = {(i, int(j)) for i, j in enumerate(apart.argmin(axis=1))}
            found |= {(int(i), j) for j, i in enumerate(apart.argmin(axis=0))}
            near = sorted((i, j) for i, j in found if apart[i, j] <= np.log(APART))
            yield str(work), str(code), [(ours[i], theirs[j]) for i, j in near]


def _front(rows: pd.DataFrame) -> list[Any]:
    """The runs that no other beats in both, the fastest first."""
    front: list[Any] = []
    for row in rows.sort_values("peer_s").itertuples():
        if not front or row.error_peer < front[-1].error_peer:
            front.append(row)
    return front


def peers(results: Path) -> str:
    """How many times as long other codes take, over all that they were compared in."""
    rows = []
    for work, code, pairs in _pairs(_rows(results, *EQUAL_ERROR)):
        times = [theirs.peer_s / ours.peer_s for ours, theirs in pairs]
        errors = [theirs.error_peer for _, theirs in pairs]
        span = f"{_span(times)}, at errors of {_span([100.0 * e for e in errors])} % of the peak"
        rows.append((work, code, span))
    lattices = _rows(results, "peers_of_the_lattice")
    rows += [
        (row.work, row.peer, f"{rounded(row.ratio)}, lift within {percent(100.0 * row.error_peer)}")
        for row in lattices[lattices["peer"] != lattices["ours"]].itertuples()
    ]
    return markdown(("", "code", "times as long as flexsurr"), _once(rows, 1))


def _span(values: list[float]) -> str:
    low, high = rounded(min(values)), rounded(max(values))
    return low if low == high else f"{low} to {high}"


def growth(results: Path) -> str:
    """Costs of a call or an epoch, of the smallest and the largest, and the exponent of the last three."""
    table = _rows(results, "scaling")
    sized = table[table["size"].notna() & (table["against"] != "trajectories")]
    what = sized["work"].str.rsplit(", ", n=1).str[0]
    rows = []
    for (of, against, peer), found in sized.groupby([what, "against", "peer"], sort=False):
        first, last = found.iloc[0], found.iloc[-1]
        power = table[(table["work"] == f"{of}: growth with {against}") & (table["peer"] == peer)]["exponent"]
        sizes = f"{against}, {first['size']:,.0f} to {last['size']:,.0f}"
        costs = f"{seconds(first['peer_s'], 2)}, {seconds(last['peer_s'], 2)}"
        rows.append((str(of), sizes, str(peer), costs, rounded(power.iloc[0])))
    return markdown(("of", "with", "", "from, to", "exponent"), _once(rows, 2))


def datasets(results: Path) -> str:
    """What simulated data takes, by the number of trajectories."""
    table = _rows(results, "scaling")
    rows = [
        (
            f"{row['size']:,.0f}",
            seconds(row["peer_s"], 2),
            f"{row['files']:.0f}",
            f"{rounded(row['files_MB'])} MB",
            f"{row['held_MB']:.0f} MB",
        )
        for _, row in table[(table["against"] == "trajectories") & table["size"].notna()].iterrows()
    ]
    return markdown(("trajectories", "one core", "files", "their size", "memory, at most"), rows)


def counted(results: Path) -> str:
    """Arithmetic and instructions of one right-hand side."""
    rows = [
        (
            row.peer,
            f"{row.operations:,.0f}",
            f"{row.instructions:,.0f}",
            rounded(row.over_floor),
            *(percent(100.0 * part / row.instructions) for part in (row.of_arithmetic, row.of_moves)),
            seconds(row.peer_s, 2),
        )
        for row in _rows(results, "counted").itertuples()
    ]
    head = ("", "operations", "instructions", "over the floor", "of them arithmetic", "moves", "one call")
    return markdown(head, rows)


def inference_goals(results: Path) -> str:
    """What the studies' rule chooses against the goals of `GOALS`."""
    table = _rows(results, "chosen")
    rows = []
    for goal, work, mark, times in GOALS:
        row = table[(table["work"] == work) & (table["mark"] == mark)].iloc[0]
        faster = 1.0 / row["ratio"]
        measured = f"{row['peer']}: {rounded(faster)} ± {rounded(row['ratio_spread'] * faster**2, 1)}"
        met = "met" if faster >= times else "**missed**"
        rows.append((goal, measured, percent(100.0 * row["error_peer"]), met))
    return markdown(("goal", "measured", "tip error", ""), rows)


def jacobians(results: Path) -> str:
    """One Jacobian by differences and analytic, and what the latter makes of responses by Radau IIA."""
    table = _rows(results, "jacobians")
    rows = []
    for surrogate, found in table.groupby("surrogate", sort=False):
        own, other = (found[found["peer"] == form].set_index("rtol") for form in ("analytic", "differences"))
        alone, responses = own[own.index.isna()].iloc[0], own[own.index.notna()]
        cells = [
            f"{_ratio(row)} ({other['evaluations'][row.Index]:,.0f} → {row.evaluations:,.0f})"
            for row in responses.itertuples()
        ]
        rows.append((str(surrogate), seconds(alone["ours_s"], 2), seconds(alone["peer_s"], 2), *cells))
    spans = (
        f"response, rtol {rtol:g} (evaluations)" for rtol in sorted(table["rtol"].dropna().unique())[::-1]
    )
    return markdown(("", "by differences", "analytic", *spans), rows)


def ensembles(results: Path) -> str:
    """Ten thousand responses by surrogate and step, with one thread and with all."""
    table = _rows(results, "ensembles")
    named = table["work"].str.extract(ENSEMBLE)
    rows = []
    for (model, step), found in table.groupby([named["model"], named["step"]], sort=False):
        walls = found.set_index("peer")["peer_s"]
        threads = [seconds(wall_s, 2) for case, wall_s in walls.items() if str(case).startswith("threads")]
        errors = rounded(found["error_of_steps"].iloc[0], 1), percent(100.0 * found["error_peer"].iloc[0])
        rows.append((str(model), f"{step} s", *threads, seconds(walls.get("one by one", np.nan), 2), *errors))
    head = ("surrogate", "step", "one thread", "two", "one by one", "error of the steps", "of the tip")
    return markdown(head, _once(rows, 1))


TABLES: dict[str, Callable[[Path], str]] = {
    "speed beside other codes": peers,
    "equal errors": equal_errors,
    "growth": growth,
    "datasets": datasets,
    "counted": counted,
    "inference goals": inference_goals,
    "jacobians": jacobians,
    "ensembles": ensembles,
    "benchmarks": side_by_side,
}
