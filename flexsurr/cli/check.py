"""Check the configuration as snakemake would, and say what it would make."""

import argparse
import sys
from pathlib import Path

from flexsurr.beam.soundness import unit_hint
from flexsurr.cli.command import personal
from flexsurr.config.settings import load
from flexsurr.workflow.plan import AnyPlan, Plan
from flexsurr.workflow.sample_plan import SamplePlan
from flexsurr.workflow.trajectory_plan import TrajectoryPlan

CONFIG = Path("config/config.yaml")


def arguments(parser: argparse.ArgumentParser) -> None:
    """The files to lay on top of config/config.yaml."""
    parser.add_argument(
        "--configfile",
        nargs="*",
        default=[],
        metavar="FILE",
        help="laid on top of config/config.yaml in this order, as snakemake --configfile does",
    )
    parser.add_argument(
        "--directory", type=Path, default=Path(), help="that holds the Snakefile; by default this one"
    )


def main(configfile: list[str], directory: Path) -> None:
    """Print a line for each study, and on stderr what looks odd of its structure.

    Raises ConfigurationError with a line for each mistake.
    """
    plan = Plan(load(directory, [str(CONFIG), *configfile]))
    for name, study in plan.studies.items():
        print(f"{name}: {_data(study)}, {len(study.runs)} runs")
        if isinstance(study, TrajectoryPlan) and (hint := unit_hint(study.resolved.structure)):
            print(f"{name}: {hint}", file=sys.stderr)


def _data(study: AnyPlan) -> str:
    """What a study learns from, in a few words."""
    match study:
        case TrajectoryPlan(variants=variants, resolved=resolved):
            datasets = len(resolved.study.datasets)
            return f"{resolved.structure.name}, {len(variants)} variants, {datasets} datasets each"
        case SamplePlan():
            return f"{len(study.datasets())} sets of samples"
    return f"{len(study.sources)} files"


if __name__ == "__main__":
    personal(main, arguments)
