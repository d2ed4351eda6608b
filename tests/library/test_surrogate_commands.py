"""The same from the shell: what a surrogate is, and its response as a file."""

import subprocess
import sys

import numpy as np
import pandas as pd
import pytest
from test_library import saved

import flexsurr
from flexsurr.training.saved_surrogate import save_surrogate


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    path = tmp_path_factory.mktemp("run") / "weights.npz"
    save_surrogate(saved(), path)
    return path


def run(*arguments):
    command = [sys.executable, "-m", "flexsurr", *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, timeout=300)


def test_it_says_what_the_surrogate_is(path):
    done = run("surrogate", path)
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.strip() == str(flexsurr.load_surrogate(path))


def test_a_response_is_what_the_library_gives(path, tmp_path):
    load = tmp_path / "load.yaml"
    load.write_text("kind: tip_force\nforce_N: 2.0\nhistory: {kind: sine, frequency_rad_s: 20.0}\n")
    output = tmp_path / "response.csv"
    done = run(
        *("simulate-surrogate", path, "--duration", 0.2, "--initial", "eta_1=0.01", "p_1=0.1"),
        *("--load", load, "--output", output),
    )
    assert (done.returncode, done.stderr) == (0, "")
    expected = flexsurr.load_surrogate(path).simulate(
        duration_s=0.2,
        initial={"eta_1": 0.01, "p_1": 0.1},
        load={"kind": "tip_force", "force_N": 2.0, "history": {"kind": "sine", "frequency_rad_s": 20.0}},
    )
    pd.testing.assert_frame_equal(pd.read_csv(output), expected.table())
    assert np.abs(expected.x[-1]).max() > 0.0


def test_a_figure_is_written_with_a_warning_where_the_surrogate_was_not_trained(path, tmp_path):
    output = tmp_path / "response.svg"
    done = run("simulate-surrogate", path, "--duration", 0.05, "--initial", "eta_1=1e3", "--output", output)
    assert done.stderr.startswith("flexsurr simulate-surrogate: eta_1 reaches 1e+03 ")
    assert "trained from" in done.stderr
    assert output.read_text().rstrip().endswith("</svg>")


@pytest.mark.parametrize(
    ("options", "code", "said"),
    [
        (("--initial", "eta_9=1", "--output", "a.csv"), 1, "'eta_9' is no state"),
        (("--initial", "eta_1", "--output", "a.csv"), 2, "eta_1"),
        (("--output", "a.doc"), 2, "allowed endings: .csv"),
        (("--load", "nothing.yaml", "--output", "a.csv"), 1, "nothing.yaml"),
    ],
)
def test_what_it_cannot_do_is_said_in_a_line(path, options, code, said):
    done = run("simulate-surrogate", path, "--duration", 0.1, *options)
    assert done.returncode == code
    assert said in done.stderr
    assert "Traceback" not in done.stderr


@pytest.mark.parametrize("command", ["surrogate", "simulate-surrogate"])
def test_a_file_that_is_none_is_refused(command, tmp_path):
    file = tmp_path / "weights.npz"
    file.write_bytes(b"rubbish")
    options = ("--duration", 1, "--output", tmp_path / "a.csv") if command == "simulate-surrogate" else ()
    done = run(command, file, *options)
    assert done.returncode == 1
    assert done.stderr == f"flexsurr {command}: {file}: not a readable .npz file\n"


def test_without_numbas_compiler_a_line_says_so(path, tmp_path, monkeypatch):
    monkeypatch.setenv("NUMBA_DISABLE_JIT", "1")
    done = run("simulate-surrogate", path, "--duration", 0.1, "--output", tmp_path / "a.csv")
    assert done.returncode == 1
    assert done.stderr.startswith("flexsurr simulate-surrogate: NUMBA_DISABLE_JIT is set, and")
    assert done.stderr.endswith("SciPy's integrators\n")
