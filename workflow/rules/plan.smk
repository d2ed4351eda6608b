# The configuration, checked before any job exists, and the plan that follows from it.

import json
import os
import sys
from contextlib import suppress
from functools import cache
from pathlib import Path

from snakemake.exceptions import WorkflowError
from snakemake.logging import logger

from flexsurr.cli.index import function_of
from flexsurr.config.errors import ConfigurationError
from flexsurr.config.settings import load
from flexsurr.workflow.batches import outdated
from flexsurr.workflow.code_digest import code_digest
from flexsurr.workflow.job_files import job_file, write_job
from flexsurr.workflow.plan import Plan

# Times are compared with one another: one thread a process, whatever the machine.
for variable in (
    "OMP_NUM_THREADS",
    "OPENBLAS_NUM_THREADS",
    "MKL_NUM_THREADS",
    "NUMEXPR_NUM_THREADS",
):
    os.environ[variable] = "1"
# Jobs run in the Python that runs Snakemake, whether or not its environment is activated.
os.environ.update(
    PATH=os.pathsep.join(
        [str(Path(sys.executable).parent), os.environ.get("PATH", os.defpath)]
    )
)

# In the order in which they are laid on top of one another: Snakemake lists its own `configfile:` last.
*on_top, base = workflow.configfiles
files = [os.path.relpath(path, workflow.basedir) for path in (base, *on_top)]

try:
    plan = Plan(load(Path(workflow.basedir), files, config))
except ConfigurationError as error:
    raise WorkflowError(str(error)) from None

RESULTS = plan.settings.results
STUDIES = list(plan.settings.studies)

# Jobs that go elsewhere read this file too; one reader needs to know.
if workflow.is_main_process:
    for line in plan.trials(Path(RESULTS) / "runs"):
        logger.info(line)
    for note in outdated(Path(RESULTS)):
        # It is wrong, and no plan is right while it is there: a dry run removes it too.
        logger.info(
            f"{note}: a file that it tells of is gone; its batch runs again where it is needed"
        )
        with suppress(OSError):
            note.unlink()


def timing_cores(wildcards):
    """What a job that measures time keeps for itself: all cores of this machine, so that it runs alone.

    A job that goes elsewhere asks for one. That its node does nothing else, it asks for in profiles/slurm.
    """
    here = workflow.resource_settings.cores if workflow.local_exec else 1
    return plan.settings.timing.cores or here or 1


def write(name, job):
    """The file that holds the values of the job `name`: a command depends on them, and on nothing else."""
    make = job_file if workflow.dryrun else write_job
    try:
        return str(make(Path(RESULTS) / "jobs", name, job))
    except OSError as error:
        # Snakemake shows a traceback of any Exception of an input function
        sys.exit(f"{error.filename or RESULTS}: {error.strerror}")


def job(rule, *keys, ending=None):
    """A function of wildcards that gives the file of the job of `rule`, and of what is no wildcard: `ending`."""

    # Snakemake asks again each time that it looks for a job to start
    @cache
    def written(*values):
        return write(f"{rule}/{'-'.join(values)}", plan.job(rule, *values))

    def path(wildcards):
        values = [wildcards[key] for key in keys]
        return written(*values, *([] if ending is None else [ending]))

    return path


def needed(files):
    """What a job waits for that reads `files`, which are named below the results."""
    return [f"{RESULTS}/{file}" for file in plan.waits_for(files)]


@cache
def code(command):
    """The digest of the code behind a command, so that editing it runs its jobs again."""
    return code_digest(function_of(command))


def caption_file(name):
    """The file that says what to see in the figure or table `name`."""
    return os.path.relpath(f"{workflow.basedir}/workflow/report/{name}.rst")


def learned_loads(wildcards):
    """The files of the study's load as it has been learned."""
    learned = plan.studies[wildcards.study].learns_load
    return [
        rules.learn_load.output[form] for form in ("polynomial", "network") if learned
    ]
