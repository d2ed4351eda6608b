"""What the selected surrogates are worth, and what they cost, beside a reference model or recordings."""

import logging
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from flexsurr.beam import EquilibriumNotFound, ModalBasis, reduce
from flexsurr.cli.command import Job, for_rules
from flexsurr.cli.runs import SELECTED, most_accurate, read_run, selected_runs, selected_surrogates
from flexsurr.config.files import FILES, FilesStudy, Rollouts
from flexsurr.config.schema import part_of
from flexsurr.config.structure import Structure
from flexsurr.config.study import Study
from flexsurr.evaluation import rollouts as of_rollouts
from flexsurr.evaluation.candidates import Candidate, with_learned_loads
from flexsurr.evaluation.cases import Response, evaluation_cases
from flexsurr.evaluation.cost import cost_table
from flexsurr.evaluation.energy import energy_table
from flexsurr.evaluation.learned_loads import learn_forces, learned_load_table
from flexsurr.evaluation.published import is_of_the_recipe
from flexsurr.evaluation.rehearsal import rehearsed
from flexsurr.evaluation.responses import response_table
from flexsurr.evaluation.rivals import Rival, name_of, rivals_table
from flexsurr.evaluation.statics import natural_frequencies, shapes_table, static_tip
from flexsurr.evaluation.validation import validation_table
from flexsurr.storage import read_manifest
from flexsurr.storage.frames import write_frame
from flexsurr.surrogates import load, load_map, save_map
from flexsurr.training import load_dataset

log = logging.getLogger(__name__)

ANIMATED_PERIODS = 5.0
FRAMES = 150


@for_rules(
    EquilibriumNotFound,
    statics="tip positions",
    frequencies="natural frequencies",
    shapes="shapes",
)
def statics(job: Job, statics: Path, frequencies: Path, shapes: Path) -> None:
    """Compute static deflection under dead loads, natural frequencies and shapes (Fig. 8, Table 3)."""
    study, basis = _reduced(job)
    others = [Structure.model_validate(values) for values in job["frequencies_also_of"]]
    bases = [basis, *(reduce(structure, study.reduction) for structure in others)]
    write_frame(statics, static_tip(study, basis))
    write_frame(frequencies, pd.concat([natural_frequencies(each) for each in bases], ignore_index=True))
    write_frame(shapes, shapes_table(study, basis))


@for_rules(EquilibriumNotFound, output="the responses")
def validate(job: Job, output: Path) -> None:
    """Simulate full and reduced order under the study's load, in both variants (Fig. 9)."""
    write_frame(output, validation_table(*_reduced(job)))


@for_rules(
    EquilibriumNotFound,
    ArithmeticError,
    **SELECTED,
    free="the free response",
    forced="the forced response",
    sustained="the response to the longest load",
    energy="the energies",
)
def respond(
    job: Job, selection: Path, runs: Path, free: Path, forced: Path, sustained: Path, energy: Path
) -> None:
    """Simulate the selected surrogates beside the reference, with their energies (Figs. 10, 12 to 15)."""
    study, basis = _reduced(job)
    surrogates = selected_surrogates(selection, job["variant"], runs)
    responses: dict[Response, Path] = {"free": free, "forced": forced, "sustained": sustained}
    for response, path in responses.items():
        write_frame(path, response_table(study, basis, job["variant"], response, surrogates))
    write_frame(energy, energy_table(study, basis, job["variant"], surrogates))


@for_rules(
    EquilibriumNotFound,
    ValueError,
    manifest="of the dataset whose configurations are learned from",
    polynomial="the forces as a polynomial",
    network="the forces as a network",
    errors="the held-out errors",
)
def learn_load(job: Job, manifest: Path, polynomial: Path, network: Path, errors: Path) -> None:
    """Learn the generalised forces of a study's load, and tabulate their errors.

    They are learned from the training trajectories, and held against the others.
    """
    study, basis = _reduced(job)
    dataset = load_dataset(manifest)
    r = basis.modes.shape[1]
    eta, held_out = dataset.x_train[:, :r], dataset.x_validation[:, :r]
    learned = learn_forces(basis, study.evaluation, eta, held_out)
    table = learned_load_table(job["study"], basis, job["variant"], learned, held_out)
    for row in table.itertuples():
        log.info("%s, %s: force within %.2e of its size", row.map, row.form, row.force_relative_error)
    save_map(learned.polynomial, polynomial)
    save_map(learned.network, network)
    write_frame(errors, table)


LOADS = {**SELECTED, "loads": "learned loads"}


@for_rules(EquilibriumNotFound, ArithmeticError, **LOADS, output="the rows rehearsed")
def rehearse(job: Job, selection: Path, runs: Path, loads: list[Path], output: Path) -> None:
    """Compile what `evaluate` will time, of which it takes what is selected and learned."""
    study, basis = _reduced(job)
    surrogates, learned = _evaluated(job, selection, runs, loads)
    tables = [
        rehearsed(study, basis, job["variant"], response, surrogates, learned[response])
        for response in learned
    ]
    write_frame(output, pd.concat(tables, ignore_index=True))


@for_rules(
    EquilibriumNotFound, ArithmeticError, **LOADS, free="the cost table", forced="the same under loads"
)
def evaluate(job: Job, selection: Path, runs: Path, loads: list[Path], free: Path, forced: Path) -> None:
    """Measure time and error of every model, implementation and integrator; alone on the machine.

    `loads` are maps to generalised forces, under which the most accurate surrogate stands in the table of
    forced responses once more; the name of the file is added to its own.
    """
    study, basis = _reduced(job)
    variant = job["variant"]
    surrogates, learned = _evaluated(job, selection, runs, loads)
    recipes = {
        name: run["architecture"]
        for name, run in selected_runs(selection, variant).items()
        if is_of_the_recipe(run)
    }
    responses: dict[Response, Path] = {"free": free, "forced": forced}
    for response, path in responses.items():
        more = learned[response]
        table = cost_table(job["study"], study, basis, variant, response, surrogates, more, recipes)
        write_frame(path, table)


def _evaluated(
    job: Job, selection: Path, runs: Path, loads: list[Path]
) -> tuple[dict[str, Any], dict[Response, list[Candidate]]]:
    """The selected surrogates, and of each response the most accurate of them under the learned `loads`."""
    variant = job["variant"]
    surrogates = selected_surrogates(selection, variant, runs)
    best = most_accurate(selection, variant)
    maps = {path.stem: load_map(path) for path in loads}
    learned = [] if best is None else with_learned_loads(best, surrogates[best], maps)
    return surrogates, {"free": [], "forced": learned}


@for_rules(EquilibriumNotFound, ArithmeticError, runs="the folder of all runs", output="the table")
def rivals(job: Job, runs: Path, output: Path) -> None:
    """Measure time and error of every run of one number of modes beside the compiled reduced model.

    Runs that have not finished are left out, with a line in the log. Alone on the machine.
    """
    study, basis = _reduced(job)
    found = []
    for key in job["runs"]:
        metrics = read_run(runs / key / "metrics.json")
        if metrics["status"] == "finished":
            found.append(Rival(key, name_of(metrics), load(runs / key / "weights.npz")))
        else:
            log.warning("%s: %s %s, %s", key, name_of(metrics), metrics["status"], metrics["reason"])
    write_frame(output, rivals_table(study, basis, "hamiltonian", found))


@for_rules(EquilibriumNotFound, ArithmeticError, ValueError, **SELECTED, output="the GIF or HTML page")
def watch(job: Job, selection: Path, runs: Path, output: Path) -> None:
    """Animate the first free response of the selected surrogates beside the reference's.

    It lasts five periods of the slowest mode, or as long as the study's own responses where they are shorter.
    """
    from flexsurr import library  # here: it draws, which no other command of this file does

    study, basis = _reduced(job)
    x0 = evaluation_cases(basis, study, "free")[0].x0
    period_s = 2.0 * np.pi / float(basis.omega_rad_s[0])
    duration_s = min(study.evaluation.duration_s, ANIMATED_PERIODS * period_s)
    given: dict[str, Any] = {"duration_s": duration_s, "step_s": duration_s / FRAMES, "initial": x0}
    responses: list[library.Response] = []
    for name, run in selected_runs(selection, job["variant"]).items():
        surrogate = library.load_surrogate(runs / run["run_id"] / "weights.npz")
        if not responses:
            responses.append(surrogate.reference(**given))
        responses.append(surrogate.simulate(**given).called(name))
    library.animate(responses, output, f"{job['study']}, {job['variant']}: free response")


@for_rules(**SELECTED, manifest="of the dataset", table="the errors", curves="states against time")
def rollouts(job: Job, selection: Path, runs: Path, manifest: Path, table: Path, curves: Path) -> None:
    """Simulate the selected surrogates along held-out trajectories of the user's files.

    `table` has the errors of every rollout, `curves` the first few of them.
    """
    settings, held_out = _held_out(job, manifest)
    surrogates = selected_surrogates(selection, FILES, runs)
    errors = of_rollouts.rollout_table(surrogates, held_out, settings.integrator)
    errors.insert(0, "study", job["study"])
    write_frame(table, errors)
    drawn = of_rollouts.rollout_curves(surrogates, held_out, settings.integrator, settings.drawn)
    write_frame(curves, drawn)


@for_rules(**SELECTED, manifest="of the dataset", output="the cost table")
def rollout_cost(job: Job, selection: Path, runs: Path, manifest: Path, output: Path) -> None:
    """Time the selected surrogates along the same trajectories; alone on the machine.

    A row is a right-hand side, or a rollout, of one surrogate.
    """
    settings, held_out = _held_out(job, manifest)
    surrogates = selected_surrogates(selection, FILES, runs)
    cost = of_rollouts.rollout_cost(surrogates, held_out, settings.integrator, settings.repeats)
    cost.insert(0, "study", job["study"])
    write_frame(output, cost)


def _held_out(job: Job, manifest: Path) -> tuple[Rollouts, of_rollouts.HeldOutTrajectories]:
    settings = part_of(FilesStudy, job["part"]).rollouts
    return settings, of_rollouts.HeldOutTrajectories.of(read_manifest(manifest), settings.trajectories)


def _reduced(job: Job) -> tuple[Study, ModalBasis]:
    """The job's part of the study, and the modes of its structure."""
    study = part_of(Study, job["part"])
    return study, reduce(Structure.model_validate(job["structure"]), study.reduction)
