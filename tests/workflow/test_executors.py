"""Jobs that run elsewhere: nobody says then how many cores there are."""

import os
import subprocess
import sys

PLANNED = """
from pathlib import Path
from snakemake.api import SnakemakeApi
from snakemake.settings.types import ConfigSettings, ResourceSettings

with SnakemakeApi() as api:
    workflow = api.workflow(
        resource_settings=ResourceSettings(nodes=2),
        config_settings=ConfigSettings(configfiles=(Path("config/presets/quick.yaml"),)),
    )
    workflow.dag().execute_workflow(executor="dryrun")
"""


def test_everything_is_planned_without_a_number_of_cores(make_project):
    """As under `--executor … --jobs 2`: jobs that measure time ask for one core, or as timing.cores says."""
    project = make_project()
    project.change("config/presets/quick.yaml", "timing", {})
    done = subprocess.run(
        [sys.executable, "-c", PLANNED],
        cwd=project.root,
        env=os.environ | {"PYTHONPATH": str(project.code)},
        capture_output=True,
        text=True,
        timeout=300,
    )
    assert done.returncode == 0, done.stderr
    assert "timing responses of cantilever" in done.stdout + done.stderr
