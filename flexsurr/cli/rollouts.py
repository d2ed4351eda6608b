"""The selected surrogates of a study of the user's files, on trajectories that no training has seen."""

from pathlib import Path

from flexsurr.cli.command import Job, for_rules
from flexsurr.cli.runs import SELECTED, selected_surrogates
from flexsurr.config.files import FILES, FilesStudy, Rollouts
from flexsurr.config.schema import part_of
from flexsurr.evaluation import rollouts as of_rollouts
from flexsurr.storage import read_manifest
from flexsurr.storage.frames import write_frame


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
