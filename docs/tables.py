"""Write what was measured into the documents: every table that stands between two marks.

    python docs/tables.py [results]

A document says `<!-- table: cost of the cantilever, free -->`, and `<!-- end of table -->` where it ends; the
words around it stay. A table whose file the results do not hold is left as it is, with a line that says so.
"""

import math
import re
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import pandas as pd
from speed_tables import TABLES as SPEED
from table_cells import markdown, percent, rounded

from flexsurr.report.crossover_figure import FAMILIES, cheapest
from flexsurr.report.style import label
from flexsurr.storage import replacing

REPOSITORY = Path(__file__).parents[1]
DOCUMENTED = ("measurements", "crossover", "flight", "speed", "ensembles")
DOCUMENTS = ("README.md", *(f"docs/{name}.md" for name in DOCUMENTED))
MARKED = re.compile(r"(<!-- table: (?P<name>[^>]+?) -->\n).*?(\n<!-- end of table -->)", re.DOTALL)

IMPLEMENTATIONS = ("described", "numpy", "compiled", "torch")
INTEGRATORS = {
    "scipy_radau": "SciPy Radau",
    "dop853_fixed": "order 8, fixed step",
    "radau_iia_5": "Radau IIA",
}
AERODYNAMICS = {
    "vlm_rebuild": "lattice rebuilt at every call",
    "vlm_frozen": "frozen, three Mach numbers at a time",
    "vlm_frozen_one_mach": "frozen at one Mach number",
    "quadratic": "quadratic form",
    "network_torch": "**network before export**: in torch, stepped from Python",
    "network": "**network after export**: compiled",
    "network_second_order": "second-order inputs",
    "network_second_order_linear_modes": "second-order inputs, linearised lattice",
}
DATASETS = {"default": "the 50", "many": "many", "configurations": "no simulation"}


def cost(results: Path, study: str, variant: str, responses: Sequence[str]) -> str:
    """Each baseline, and each surrogate, compiled with the study's first integrator and in torch."""
    table = pd.read_csv(results / f"tables/{study}/cost.csv")
    table = table[(table["variant"] == variant) & table["response"].isin(responses)]
    method = table["integrator"].str.split("(").str[0]
    first = table.loc[method != "scipy_radau", "integrator"].iloc[0]
    baseline = (table["model"] == "rom") & (table["integrator"].isin(["scipy_radau", first]))
    shown = baseline | (table["integrator"] == first) | (table["implementation"] == "torch")
    rows = []
    for response in responses:
        said: tuple[str, str] = ("", "")
        for row in table[shown & (table["response"] == response)].itertuples():
            name = "reduced model" if row.model == "rom" else label(row.model)
            now = (response, name)
            rows.append(
                (
                    *(() if len(responses) == 1 else ("" if said[0] == response else response,)),
                    "" if said == now else name,
                    f"{row.implementation}, {INTEGRATORS[row.integrator.split('(')[0]]}",
                    rounded(row.wall_s_mean),
                    percent(row.relative_to_described_percent),
                    percent(row.relative_to_numpy_percent),
                    percent(row.relative_to_compiled_percent),
                    percent(row.tip_error_percent),
                )
            )
            said = now
    head = ("model", "implementation, integrator", "wall s", "of described", "of numpy")
    head = (*head, "of compiled, same integrator", "worst tip error")
    return markdown(head if len(responses) == 1 else ("response", *head), rows)


def trials(results: Path, study: str, variant: str) -> str:
    """architectures.csv: what every architecture reached, and what it took."""
    table = pd.read_csv(results / f"tables/{study}/architectures.csv")
    trained = pd.read_csv(results / f"tables/{study}/training.csv")
    table = table.merge(trained[["variant", "run_id", "processor_s", "terms"]], on=["variant", "run_id"])
    table = table[(table["variant"] == variant) & (table["status"] == "finished")]
    order = ["architecture", "mass_matrix", "hidden", "degree", "activation", "dataset"]
    rows = [
        (
            label(row.architecture),
            _size(row),
            DATASETS.get(row.dataset, row.dataset),
            str(row.optimiser).replace("_", " "),
            f"{row.parameters:.0f}",
            rounded(row.processor_s),
            rounded(row.held_out_nmse),
            _both(row.long_response_error_percent_median, row.long_response_error_percent_worst),
        )
        for row in table.sort_values(order, kind="stable").itertuples()
    ]
    head = ("model", "", "trained on", "by", "parameters", "processor s")
    return markdown((*head, "held-out nmse", "tip error, median / worst"), rows)


def _size(row: Any) -> str:
    """Degree, or neurons and activation, and what else the name of a trial would say."""
    degree = f"degree {row.degree:.0f}" if pd.notna(row.degree) else ""
    hidden = str(row.hidden).removesuffix(".0") if pd.notna(row.hidden) else ""
    unusual = [name for name in (row.scaling, row.terms) if name in ("per_feature", "sparse")]
    named = (row.activation, row.mass_matrix, *unusual)
    return " ".join(filter(None, [degree, hidden, *(str(n) for n in named if pd.notna(n))]))


def _both(median: float, worst: float) -> str:
    """Two errors in per cent; a word where a response never ended."""
    return f"{rounded(median)} / {percent(worst)}" if math.isfinite(worst) else "diverges"


def crossover(results: Path) -> str:
    """The cheapest rival of each kind within the allowed error."""
    table = pd.read_csv(results / "tables/crossover.csv")
    found = cheapest(table)
    reference = table[table["model"] == "rom"].set_index("modes")["wall_s"]
    rows = []
    for modes, wall_s in reference.items():
        of_these = found[found["modes"] == modes].set_index("family")
        cells = []
        for family in FAMILIES:
            if family not in of_these.index:
                cells.append("none")
                continue
            row = of_these.loc[family]
            name = str(row["model"]).replace("_", " ")
            part, error = row["relative_to_compiled_percent"], row["tip_error_percent"]
            cells.append(f"{part:.0f} % ({name}; {percent(error)})")
        rows.append((str(modes), f"{wall_s * 1e3:.0f} ms", *cells))
    return markdown(("modes", "reduced model, 30 s", *FAMILIES), rows)


def flights(results: Path) -> str:
    """airliner_cost.csv: what a flight takes with each model of the aerodynamics."""
    table = pd.read_csv(results / "tables/airliner_cost.csv")
    of_rebuilt = table["relative_to_vlm_rebuild_percent"]
    rows = [
        (
            AERODYNAMICS.get(row.model, row.model.replace("_", " ")),
            rounded(row.wall_s_mean),
            f"{rounded(of_rebuilt[row.Index], 3)} ± {percent(row.relative_to_vlm_rebuild_std_percent, 1)}",
            percent(row.relative_to_vlm_frozen_percent),
            percent(row.relative_to_vlm_frozen_one_mach_percent),
            percent(row.worst_error_percent),
            percent(row.median_error_percent),
        )
        for row in table.sort_values("wall_s_mean", ascending=False).itertuples()
    ]
    head = ("", "s", "of the lattice rebuilt", "of the frozen one", "of one frozen at a Mach number")
    return markdown((*head, "worst error of all flights", "median flight's worst"), rows)


TABLES: dict[str, Callable[[Path], str]] = {
    "cost of the cantilever, free": lambda results: cost(results, "cantilever", "hamiltonian", ["free"]),
    "cost of the cantilever": lambda results: cost(results, "cantilever", "hamiltonian", ["free", "forced"]),
    "cost of the wing": lambda results: cost(results, "wing", "hamiltonian", ["free", "forced"]),
    "cost of the wing, as printed": lambda results: cost(results, "wing", "as_printed", ["free", "forced"]),
    "trials of the cantilever": lambda results: trials(results, "cantilever", "hamiltonian"),
    "trials of the wing": lambda results: trials(results, "wing", "hamiltonian"),
    "trials of the wing, as printed": lambda results: trials(results, "wing", "as_printed"),
    "cost of flights": flights,
    "crossover": crossover,
    **SPEED,
}


def written(text: str, results: Path) -> str:
    """The document `text` with every marked table anew. Raises KeyError for a mark of no table."""

    def anew(mark: re.Match[str]) -> str:
        try:
            table = TABLES[mark["name"]](results)
        except FileNotFoundError as error:
            print(f"{mark['name']}: left as it is, for there is no {error.filename}")
            return mark[0]
        return f"{mark[1]}\n{table}\n{mark[3]}"

    return MARKED.sub(anew, text)


def main() -> None:
    """Every document anew."""
    results = Path(sys.argv[1] if len(sys.argv) > 1 else "results")
    for name in DOCUMENTS:
        document = REPOSITORY / name
        text = document.read_text(encoding="utf-8")
        with replacing(document) as beside:
            beside.write_text(written(text, results), encoding="utf-8")


if __name__ == "__main__":
    main()
