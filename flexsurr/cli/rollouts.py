"""Let the selected surrogates follow the held-out trajectories of a study of the user's files."""

from pathlib import Path

from flexsurr.cli.command import Job, command
from flexsurr.cli.frames import write_frame
from flexsurr.cli.selected import selected_surrogates
from flexsurr.config.files import FILES, FilesStudy
from flexsurr.config.part import part_of
from flexsurr.evaluation.rollouts import HeldOutTrajectories, rollout_curves, rollout_table
from flexsurr.storage import read_manifest


def main(job: Job, selection: Path, runs: Path, manifest: Path, table: Path, curves: Path) -> None:
    """Write the errors of every rollout, and the curves of the first few."""
    settings = part_of(FilesStudy, job["part"]).rollouts
    surrogates = selected_surrogates(selection, FILES, runs)
    held_out = HeldOutTrajectories.of(read_manifest(manifest), settings.trajectories)
    errors = rollout_table(surrogates, held_out, settings.integrator)
    errors.insert(0, "study", job["study"])
    write_frame(table, errors)
    write_frame(curves, rollout_curves(surrogates, held_out, settings.integrator, settings.drawn))


if __name__ == "__main__":
    command(
        main,
        {
            "selection": "the selected runs",
            "runs": "the folder of all runs",
            "manifest": "of the dataset",
            "table": "the errors",
            "curves": "states against time",
        },
    )
