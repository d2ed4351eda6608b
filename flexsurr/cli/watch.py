"""Animate the first free response of the selected surrogates beside the reference's."""

from pathlib import Path
from typing import Any

import numpy as np

from flexsurr.beam import EquilibriumNotFound, reduce
from flexsurr.cli.command import Job, command
from flexsurr.cli.selected import selected_runs
from flexsurr.config.part import part_of
from flexsurr.config.structure import Structure
from flexsurr.config.study import Study
from flexsurr.evaluation.cases import evaluation_cases
from flexsurr.library import Response, animate, load_surrogate

PERIODS = 5.0
FRAMES = 150


def main(job: Job, selection: Path, runs: Path, output: Path) -> None:
    """Write five periods of the slowest mode, or the whole response if that is shorter, to `output`."""
    study, variant = part_of(Study, job["part"]), job["variant"]
    basis = reduce(Structure.model_validate(job["structure"]), study.reduction)
    x0 = evaluation_cases(basis, study, "free")[0].x0
    duration_s = min(study.evaluation.duration_s, PERIODS * 2.0 * np.pi / float(basis.omega_rad_s[0]))
    responses: list[Response] = []
    for name, run in selected_runs(selection, variant).items():
        surrogate = load_surrogate(runs / run["run_id"] / "weights.npz")
        given: dict[str, Any] = {"duration_s": duration_s, "step_s": duration_s / FRAMES, "initial": x0}
        if not responses:
            responses.append(surrogate.reference(**given))
        responses.append(surrogate.simulate(**given).called(name))
    animate(responses, output, f"{job['study']}, {variant}: free response")


if __name__ == "__main__":
    command(
        main,
        {
            "selection": "the selected runs",
            "runs": "the folder of all runs",
            "output": "the GIF or HTML page",
        },
        expected=(EquilibriumNotFound, ArithmeticError, ValueError),
    )
