# The whole study: simulate, train, choose, evaluate, draw.
#
#     snakemake --cores 2
#     snakemake --cores 2 --configfile config/presets/quick.yaml
#
# Here the configuration is checked and the rules are included; the jobs are planned in
# flexsurr/workflow/plan.py, and each rule runs one command of flexsurr/cli. Where several jobs could
# start, the `priority` of their rules says which does: data, then what takes minutes, then the rest;
# what is timed comes last, for it waits until every core is free.

from pathlib import Path

from snakemake.exceptions import WorkflowError
from snakemake.utils import min_version

from flexsurr.config.errors import ConfigurationError
from flexsurr.config.reading import read_yaml

min_version("9.20")

# Snakemake would say that the file is not YAML, but neither which file nor where in it.
try:
    read_yaml(Path("config/config.yaml"))
except ConfigurationError as error:
    raise WorkflowError(str(error)) from None


configfile: "config/config.yaml"


report: "workflow/report/workflow.rst"


include: "workflow/rules/plan.smk"
include: "workflow/rules/data.smk"
include: "workflow/rules/learning.smk"
include: "workflow/rules/evaluation.smk"
include: "workflow/rules/report.smk"
include: "workflow/rules/progress.smk"


if plan.of_source("samples"):

    include: "workflow/rules/flight.smk"


rule all:
    default_target: True
    input:
        [
            f"{RESULTS}/figures/{study}/{name}.svg"
            for study in STUDIES
            for name in plan.figures(study)
        ],
        rules.join.output,
        rules.answer.output if "cost" in ALL_TABLES else [],
        # a run that has been deleted comes back
        needed(file for study in STUDIES for file in plan.files(study, "metrics")),
