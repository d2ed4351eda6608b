"""Time the selected surrogates on held-out trajectories of the user's files; alone on the machine."""

from pathlib import Path

from flexsurr.cli.command import Job, command
from flexsurr.cli.frames import write_frame
from flexsurr.cli.selected import selected_surrogates
from flexsurr.config.files import FILES, FilesStudy
from flexsurr.config.part import part_of
from flexsurr.evaluation.rollouts import HeldOutTrajectories, rollout_cost
from flexsurr.storage import read_manifest


def main(job: Job, selection: Path, runs: Path, manifest: Path, output: Path) -> None:
    """Write what a right-hand side and a rollout of each surrogate cost."""
    settings = part_of(FilesStudy, job["part"]).rollouts
    surrogates = selected_surrogates(selection, FILES, runs)
    held_out = HeldOutTrajectories.of(read_manifest(manifest), settings.trajectories)
    cost = rollout_cost(surrogates, held_out, settings.integrator, settings.repeats)
    cost.insert(0, "study", job["study"])
    write_frame(output, cost)


if __name__ == "__main__":
    command(
        main,
        {
            "selection": "the selected runs",
            "runs": "the folder of all runs",
            "manifest": "of the dataset",
            "output": "the cost table",
        },
    )
