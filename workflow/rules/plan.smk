# The configuration, checked before any job exists, and the plan that follows from it.

import json
import os
from pathlib import Path

from snakemake.exceptions import WorkflowError

from flexsurr.config.errors import ConfigurationError
from flexsurr.config.settings import load
from flexsurr.workflow.code_digest import code_digest
from flexsurr.workflow.plan import Plan

# Times are compared with one another: one thread a process, whatever the machine.
for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMEXPR_NUM_THREADS"):
    os.environ[variable] = "1"

try:
    plan = Plan(load(Path(workflow.basedir), [str(path) for path in workflow.configfiles], config))
except ConfigurationError as error:
    raise WorkflowError(str(error)) from None

RESULTS = plan.settings.results
STUDIES = list(plan.studies)
PYTHON = "python -m flexsurr.cli"


def job(rule, *keys):
    """A function of wildcards that gives the job of `rule` as JSON: what it depends on, and nothing else."""
    return lambda wildcards: json.dumps(getattr(plan, rule)(*(wildcards[key] for key in keys)), sort_keys=True)


def code(command):
    """The digest of the code behind a command, so that editing it runs its jobs again."""
    return code_digest(f"flexsurr.cli.{command}")
