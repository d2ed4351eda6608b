"""The workflow on a real Slurm: the same tables, few jobs, and what is timed has its node alone."""

import os
import re

import pandas as pd
import pytest
from one_machine_slurm import one_machine_slurm

BEAM = "cantilever"
TIMED = re.compile("wall_s|processor_s|relative_to_")
# The node is no login node: it answers at once, and its file system too.
AT_ONCE = ("--slurm-init-seconds-before-status-checks", "2", "--latency-wait", "5")
OF_THIS_SLURM = ("--slurm-status-command", "squeue", "--slurm-no-account")


@pytest.fixture(scope="module")
def slurm(tmp_path_factory):
    with (
        one_machine_slurm(tmp_path_factory.mktemp("slurm")) as running,
        pytest.MonkeyPatch.context() as patch,
    ):
        patch.setenv("PATH", f"{running.commands}{os.pathsep}{os.environ['PATH']}")
        yield running


@pytest.fixture(scope="module")
def through_slurm(slurm, make_project):
    """The tables of the cantilever, every job through Slurm as profiles/slurm says, trials in a batch."""
    project = make_project()
    project.change("config/presets/quick.yaml", "batches", {"trials_per_job": 20, "shards_per_job": 1})
    tables = [f"results/tables/{BEAM}/{name}.html" for name in project.plan.tables(BEAM)]
    project.run_well("--profile", "profiles/slurm", *OF_THIS_SLURM, *AT_ONCE, *tables)
    return project


def is_of(rule: str, job) -> bool:
    """Whether a job of Slurm holds jobs of a rule; those that draw are named after other rules too."""
    return rule in re.sub(r"(draw|tabulate)_[\w.-]+", r"\1", job.comment)


def tables_of(project) -> dict[str, pd.DataFrame]:
    """The tables of the cantilever, without what was timed."""
    tables = {}
    for path in sorted((project.results / "tables" / BEAM).glob("*.csv")):
        table = pd.read_csv(path)
        tables[path.name] = table.drop(columns=[name for name in table if TIMED.search(name)])
    return tables


def test_the_tables_are_the_same(quick, through_slurm):
    here, there = tables_of(quick), tables_of(through_slurm)
    assert list(there) == list(here)
    assert "cost.csv" in here
    for name, table in here.items():
        pd.testing.assert_frame_equal(there[name], table, obj=name)


@pytest.mark.parametrize("rule", ["simulate", "manifest", "statics", "trials", "learn_load", "tabulate"])
def test_small_work_makes_one_job(through_slurm, slurm, rule):
    assert len([job for job in slurm.jobs() if is_of(rule, job)]) == 1


def test_what_is_timed_has_its_node_alone(through_slurm, slurm):
    jobs = slurm.jobs()
    timed = [job for job in jobs if is_of("evaluate", job)]
    assert len(timed) == len(through_slurm.plan.studies[BEAM].variants)
    for job in timed:
        assert job.alone
        others = [other for other in jobs if other is not job]
        assert all(other.end <= job.start or other.start >= job.end for other in others)


def test_a_log_of_each_job_of_the_workflow_is_where_it_always_is(through_slurm):
    logs = list(through_slurm.results.glob("logs/*/*.log"))
    assert {"simulate", "trials", "evaluate", "tabulate"} <= {path.parent.name for path in logs}
    # a command without anything to tell leaves an empty one
    assert {"simulate", "trials", "evaluate"} <= {path.parent.name for path in logs if path.stat().st_size}
