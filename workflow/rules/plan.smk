# The configuration, checked before any job exists, and the plan that follows from it.

import json
import os
import sys
from pathlib import Path

from snakemake.exceptions import WorkflowError

from flexsurr.config.errors import ConfigurationError
from flexsurr.config.settings import load
from flexsurr.workflow.code_digest import code_digest
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
os.environ["PATH"] = os.pathsep.join(
    [str(Path(sys.executable).parent), os.environ["PATH"]]
)

# In the order in which they are laid on top of one another: Snakemake lists its own `configfile:` last.
*on_top, base = workflow.configfiles
files = [os.path.relpath(path, workflow.basedir) for path in (base, *on_top)]

try:
    plan = Plan(load(Path(workflow.basedir), files, config))
except ConfigurationError as error:
    raise WorkflowError(str(error)) from None

RESULTS = plan.settings.results
STUDIES = list(plan.studies)
AIRLINER = plan.settings.airliner is not None


def job(rule, *keys):
    """A function of wildcards that gives the job of `rule` as JSON: what it depends on, and nothing else."""
    return lambda wildcards: json.dumps(
        getattr(plan, rule)(*(wildcards[key] for key in keys)), sort_keys=True
    )


def code(command):
    """The digest of the code behind a command, so that editing it runs its jobs again."""
    return code_digest(f"flexsurr.cli.{command}")
