"""Check the configuration as snakemake would, and say what it would make."""

import argparse
from pathlib import Path

from flexsurr.cli.command import personal
from flexsurr.config.settings import load
from flexsurr.config.sources import ResolvedFiles
from flexsurr.workflow.plan import Plan

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
    """Print a line for each study. Raises ConfigurationError with a line for each mistake."""
    plan = Plan(load(directory, [str(CONFIG), *configfile]))
    for name, resolved in plan.studies.items():
        runs = len(plan.runs_of(name))
        if isinstance(resolved, ResolvedFiles):
            print(f"{name}: {len(plan.sources(name))} files, {runs} runs")
            continue
        variants, datasets = len(plan.variants(name)), len(resolved.study.datasets)
        print(
            f"{name}: {resolved.structure.name}, {variants} variants, {datasets} datasets each, {runs} runs"
        )
    for name, samples in plan.of_samples.items():
        print(f"{name}: {len(samples.runs)} runs")


if __name__ == "__main__":
    personal(main, arguments)
