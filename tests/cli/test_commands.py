"""How commands end: well, with one line for what was to be expected, with a traceback for what was not."""

import os
import re
import signal
import subprocess
import sys
from importlib import import_module
from pathlib import Path

import pytest

from flexsurr.cli import index
from flexsurr.cli.command import COMMANDS
from flexsurr.cli.index import FOR_PEOPLE, FOR_RULES, purposes
from flexsurr.cli.report import join
from flexsurr.config.settings import load
from flexsurr.storage import read_shard
from flexsurr.workflow.job_files import write_job
from flexsurr.workflow.plan import Plan
from flexsurr.workflow.sample_plan import SamplePlan

REPOSITORY = Path(__file__).resolve().parents[2]
PLAN = Plan(load(REPOSITORY, ["config/config.yaml", "config/presets/quick.yaml"]))
TROUBLE = [
    ("OSError(28, 'No space left on device', 'weights.npz')", "weights.npz: No space left on device"),
    ("OSError(5, 'Input/output error')", "Input/output error"),
    ("PermissionError(13, 'Permission denied', 'results')", "results: Permission denied"),
    ("MemoryError('Unable to allocate 8 TiB')", "Unable to allocate 8 TiB"),
    ("MemoryError()", "out of memory"),
    ("EOFError('Ran out of input')", "/kept/here: damaged machine code; delete it, and it is compiled anew"),
]
SLEEPER = """
import sys
import time
from flexsurr.cli.command import for_rules, run

@for_rules()
def sleep(job):
    try:
        print("at work", flush=True)
        time.sleep(60)
    finally:
        print("closed", flush=True)

run("sleep", "", sys.argv[1:])
"""


def run(*arguments: str) -> subprocess.CompletedProcess:
    return subprocess.run(
        [sys.executable, "-m", "flexsurr", *arguments],
        cwd=REPOSITORY,
        capture_output=True,
        text=True,
        timeout=120,
    )


def test_a_shard_depends_on_its_number_alone(tmp_path):
    """The second shard is the same whether or not there is a first, and however often it is made."""
    job = write_job(tmp_path, "simulate", PLAN.studies["cantilever"].simulate("hamiltonian", 1))
    paths = [tmp_path / "a.parquet", tmp_path / "b.parquet"]
    for path in paths:
        done = run("simulate", "--job", str(job), "--output", str(path))
        assert done.returncode == 0, done.stderr
    assert paths[0].read_bytes() == paths[1].read_bytes()
    shard = read_shard(paths[0])
    assert (shard.metadata.first, shard.metadata.count) == (3, 3)
    assert shard.metadata.seed == PLAN.studies["cantilever"].resolved.study.seed


def test_what_is_to_be_expected_is_one_line(tmp_path):
    rubbish = tmp_path / "shard-0000.parquet"
    rubbish.write_bytes(b"rubbish")
    job = write_job(tmp_path, "manifest", PLAN.studies["cantilever"].manifest("hamiltonian") | {"shards": 1})
    output = tmp_path / "manifest.json"
    done = run("manifest", "--job", str(job), "--folder", str(tmp_path), "--output", str(output))
    assert done.returncode == 1
    assert done.stderr.startswith(f"flexsurr manifest: {rubbish}: damaged or truncated")
    assert len(done.stderr.splitlines()) == 1
    assert not (tmp_path / "manifest.json").exists()


def test_what_is_not_to_be_expected_leaves_its_traceback(tmp_path):
    job = write_job(tmp_path, "manifest", {})
    done = run("manifest", "--job", str(job), "--folder", "x", "--output", str(tmp_path / "manifest.json"))
    assert done.returncode == 1
    assert "Traceback" in done.stderr
    assert "KeyError" in done.stderr


@pytest.mark.parametrize("integrator", ["dop853_fixed", "scipy_radau"])
def test_without_numbas_compiler_a_line_says_so(tmp_path, monkeypatch, integrator):
    monkeypatch.setenv("NUMBA_DISABLE_JIT", "1")
    values = PLAN.studies["cantilever"].simulate("hamiltonian", 0)
    values["part"]["dataset"]["integrator"]["method"] = integrator
    job = write_job(tmp_path, "simulate", values)
    done = run("simulate", "--job", str(job), "--output", str(tmp_path / "shard-0000.parquet"))
    assert done.returncode == 1
    assert "Traceback" not in done.stderr
    assert done.stderr.splitlines()[-1].startswith("flexsurr simulate: NUMBA_DISABLE_JIT is set")


@pytest.mark.parametrize(("trouble", "said"), TROUBLE)
def test_what_the_machine_refuses_is_one_line(tmp_path, monkeypatch, trouble, said):
    monkeypatch.setenv("NUMBA_CACHE_DIR", "/kept/here")
    code = f"""
import sys
from flexsurr.cli.command import for_rules, run

@for_rules()
def refuse(job):
    raise {trouble}

run("refuse", "", sys.argv[1:])
"""
    job = write_job(tmp_path, "refused", {})
    words = [sys.executable, "-c", code, "--job", str(job)]
    done = subprocess.run(words, cwd=REPOSITORY, capture_output=True, text=True, timeout=120)
    assert (done.returncode, done.stderr) == (1, f"flexsurr refuse: {said}\n")


@pytest.mark.parametrize("content", ["{", "[]", None])
def test_what_is_no_job_is_refused(tmp_path, content):
    job = tmp_path / "job.json"
    if content is not None:
        job.write_text(content)
    done = run("manifest", "--job", str(job), "--folder", "x", "--output", "y")
    assert done.returncode == 2
    assert "is no job" in done.stderr
    assert "Traceback" not in done.stderr


@pytest.mark.parametrize(("sent", "code"), [(signal.SIGTERM, 143), (signal.SIGINT, 130)])
def test_a_command_told_to_stop_closes_what_is_open(tmp_path, sent, code):
    with subprocess.Popen(
        [sys.executable, "-c", SLEEPER, "--job", write_job(tmp_path, "sleep", {})],
        cwd=REPOSITORY,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    ) as process:
        assert process.stdout.readline() == "at work\n"
        os.kill(process.pid, sent)
        output, errors = process.communicate(timeout=60)
    assert output == "closed\n"
    assert process.returncode == code
    assert "Traceback" not in errors


def test_help_lists_every_command_of_the_rules_and_what_each_code_means():
    text = run("--help").stdout
    rules = "".join(path.read_text() for path in (REPOSITORY / "workflow" / "rules").glob("*.smk"))
    called = set(re.findall(r"python -m flexsurr ([a-z-]+)", rules)) | {
        command for pair in SamplePlan.commands.items() for command in pair
    }
    of_rules, of_people = (
        {name for names in of.values() for name in names} for of in (FOR_RULES, FOR_PEOPLE)
    )
    assert of_rules <= called <= of_rules | of_people
    for part in (*purposes().items(), "for you", "snakemake", "130"):
        for word in (part,) if isinstance(part, str) else part:
            assert word in text


def test_the_index_has_every_command_where_it_stands():
    for module in {*FOR_PEOPLE, *FOR_RULES}:
        import_module(f"flexsurr.cli.{module}")
    declared = {name: command.work.__module__ for name, command in COMMANDS.items()}
    assert set(declared) == set(purposes())
    assert all(index.function_of(name).partition(":")[0] == module for name, module in declared.items())
    assert all(purposes().values())


@pytest.mark.parametrize(("arguments", "code"), [((), 2), (("fly-away",), 2), (("--version",), 0)])
def test_the_exit_code_says_whether_it_was_called_rightly(arguments, code):
    done = run(*arguments)
    assert done.returncode == code
    assert len(done.stderr.splitlines()) == (1 if arguments == ("fly-away",) else 0)


def test_each_command_explains_itself_by_the_name_it_is_called():
    done = run("learn-load", "--help")
    assert done.returncode == 0
    assert done.stdout.startswith("usage: flexsurr learn-load ")
    assert purposes()["learn-load"] in " ".join(done.stdout.split())


def test_the_list_of_commands_needs_no_library():
    code = "import sys, flexsurr.__main__ as m; m.overview(); print({'numpy', 'pydantic'} & set(sys.modules))"
    done = subprocess.run([sys.executable, "-c", code], cwd=REPOSITORY, capture_output=True, text=True)
    assert done.stdout.strip() == "set()", done.stderr


def test_checking_says_what_there_is_to_do(tmp_path):
    done = run("check", "--configfile", "config/presets/quick.yaml")
    assert done.returncode == 0, done.stderr
    runs = len(PLAN.studies["wing"].runs)
    assert f"wing: wing, 1 variants, 2 datasets each, {runs} runs" in done.stdout


def test_checking_says_what_is_wrong_in_a_line_each(tmp_path):
    wrong = tmp_path / "wrong.yaml"
    wrong.write_text("overrides: {wing: {seed: -1, colour: blue}}")
    done = run("check", "--configfile", str(wrong))
    assert done.returncode == 1
    assert "Traceback" not in done.stderr
    assert "seed" in done.stderr
    assert "colour" in done.stderr


def test_simulating_needs_neither_torch_nor_mlflow_nor_matplotlib():
    heavy = {"torch", "mlflow", "matplotlib", "pandas"}
    code = f"import sys, flexsurr.cli.trajectories; print({heavy} & set(sys.modules))"
    done = subprocess.run([sys.executable, "-c", code], cwd=REPOSITORY, capture_output=True, text=True)
    assert done.stdout.strip() == "set()", done.stderr


@pytest.mark.parametrize("module", ["cli.report", "workflow.plan"])
def test_tables_and_plans_need_neither_kernels_nor_figures(module):
    heavy = {"numba", "scipy", "matplotlib", "torch", "mlflow"}
    code = f"import sys, flexsurr.{module}; print({heavy} & set(sys.modules))"
    done = subprocess.run([sys.executable, "-c", code], cwd=REPOSITORY, capture_output=True, text=True)
    assert done.stdout.strip() == "set()", done.stderr


def test_tables_of_one_name_are_joined_to_the_letter(tmp_path):
    for study, cost in (("beam", "0.10"), ("wing", "1e-07")):
        (tmp_path / study).mkdir()
        (tmp_path / study / "cost.csv").write_text(f"study,wall_s\n{study},{cost}\n")
        (tmp_path / study / "runs.csv").write_text(f"study\n{study}\n")
    inputs = [tmp_path / study / f"{name}.csv" for name in ("cost", "runs") for study in ("beam", "wing")]
    join({}, inputs, tmp_path)
    assert (tmp_path / "cost.csv").read_text() == "study,wall_s\nbeam,0.10\nwing,1e-07\n"
    assert (tmp_path / "runs.csv").read_text() == "study\nbeam\nwing\n"
