"""Time and judge every model, implementation and integrator under one response; alone on the machine."""

from pathlib import Path

from flexsurr.beam import EquilibriumNotFound, reduce
from flexsurr.cli.command import Job, command
from flexsurr.cli.frames import write_frame
from flexsurr.cli.selected import most_accurate, selected_runs, selected_surrogates
from flexsurr.config.part import part_of
from flexsurr.config.structure import Structure
from flexsurr.config.study import Study
from flexsurr.evaluation.contenders import with_learned_loads
from flexsurr.evaluation.cost import cost_table
from flexsurr.evaluation.published import is_of_the_recipe
from flexsurr.surrogates import load_map


def main(job: Job, selection: Path, runs: Path, loads: list[Path], output: Path) -> None:
    """Write the cost table of one variant and response.

    `loads` are maps to generalised forces, under which the most accurate surrogate stands in the table once
    more; the name of the file is added to its own.
    """
    study, variant = part_of(Study, job["part"]), job["variant"]
    basis = reduce(Structure.model_validate(job["structure"]), study.reduction)
    surrogates = selected_surrogates(selection, variant, runs)
    best = most_accurate(selection, variant)
    maps = {path.stem: load_map(path) for path in loads}
    learned = [] if best is None else with_learned_loads(best, surrogates[best], maps)
    recipes = {
        name: run["architecture"]
        for name, run in selected_runs(selection, variant).items()
        if is_of_the_recipe(run)
    }
    table = cost_table(job["study"], study, basis, variant, job["response"], surrogates, learned, recipes)
    write_frame(output, table)


if __name__ == "__main__":
    command(
        main,
        {
            "selection": "the selected runs",
            "runs": "the folder of all runs",
            "loads": "learned loads …",
            "output": "the cost table",
        },
        expected=(EquilibriumNotFound, ArithmeticError),
    )
