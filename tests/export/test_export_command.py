"""`flexsurr export`: each form of a saved run as a file, and a line where that cannot be."""

import subprocess
import sys
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
from exported_models import WING, aerodynamics, maps, port_polynomial

from flexsurr.beam import reduce
from flexsurr.cli.export import export
from flexsurr.config.study import Reduction
from flexsurr.export import (
    NotExported,
    c_header,
    exported_map,
    exported_surrogate,
    fmu,
    numpy_file,
    onnx_file,
)
from flexsurr.surrogates import SurrogateFileError, save_map
from flexsurr.training.saved_surrogate import SavedSurrogate, save_surrogate

WING_RUN, MAP_RUN = "port_hamiltonian-0123456789", "network-0123456789"
AERODYNAMICS_RUN = "polynomial-0123456789"
CONFIG = Path(__file__).resolve().parents[2] / "config"


@pytest.fixture(scope="module")
def runs(tmp_path_factory):
    """A folder with the runs of a surrogate and of a map, and both as models to export."""
    folder = tmp_path_factory.mktemp("project")
    for name in (WING_RUN, MAP_RUN, AERODYNAMICS_RUN):
        (folder / "results/runs" / name).mkdir(parents=True)
    surrogate = port_polynomial(6, 4, even=True)
    basis = reduce(WING, Reduction(modes=3, normalisation="mass"))
    saved = SavedSurrogate(surrogate, "wing", "hamiltonian", WING_RUN, np.full(6, -1.0), np.ones(6), basis)
    save_surrogate(saved, folder / "results/runs" / WING_RUN / "weights.npz")
    learned = maps()["map network"]
    save_map(learned, folder / "results/runs" / MAP_RUN / "weights.npz")
    save_map(aerodynamics(), folder / "results/runs" / AERODYNAMICS_RUN / "weights.npz")
    (folder / "config").symlink_to(CONFIG)
    coefficients = {"output_units": ("1", "1")}
    return folder, exported_surrogate(saved), exported_map(learned, MAP_RUN, **coefficients)


@pytest.fixture(autouse=True)
def in_the_project(runs, monkeypatch):
    monkeypatch.chdir(runs[0])


def test_the_command_writes_the_form_and_says_where(runs):
    command = [sys.executable, "-m", "flexsurr", "export", WING_RUN, "--to", "c"]
    done = subprocess.run(command, cwd=runs[0], capture_output=True, text=True, timeout=300)
    assert (done.returncode, done.stdout, done.stderr) == (0, "port_hamiltonian_0123456789.h\n", "")
    assert (runs[0] / "port_hamiltonian_0123456789.h").read_text() == c_header(runs[1])


@pytest.mark.parametrize("run", [f"results/runs/{MAP_RUN}", f"results/runs/{MAP_RUN}/weights.npz", MAP_RUN])
def test_a_run_is_named_in_three_ways(runs, run, tmp_path, capsys):
    export(run, "numpy", None, None, tmp_path / "map.py")
    assert (tmp_path / "map.py").read_text() == numpy_file(runs[2])
    assert capsys.readouterr().out == f"{tmp_path / 'map.py'}\n"


@pytest.mark.parametrize(("to", "write"), [("onnx", onnx_file), ("fmu", fmu)])
def test_binary_forms_are_those_of_the_library(runs, to, write, tmp_path):
    export(WING_RUN, to, None, None, tmp_path / "wing")
    assert (tmp_path / "wing").read_bytes() == write(runs[1])


def test_another_name_is_that_of_all_that_is_defined(tmp_path):
    export(WING_RUN, "c", None, "wing", tmp_path / "wing.h")
    text = (tmp_path / "wing.h").read_text()
    assert "static inline void wing_rates(" in text
    assert "port_hamiltonian_0123456789_" not in text


def test_the_aircraft_is_exported_in_trim(tmp_path):
    export(AERODYNAMICS_RUN, "numpy", "airliner", None, tmp_path / "airliner.py")
    module = ModuleType("airliner")
    exec((tmp_path / "airliner.py").read_text(), module.__dict__)
    rates = module.rates(module.START)
    speed, mach, *_ = module.outputs(module.START)
    assert mach == pytest.approx(0.7)
    assert rates[list(module.STATES).index("north_m")] == pytest.approx(speed)
    assert np.abs(rates[1:]).max() < 1e-8
    assert list(module.INPUTS)[-1] == "thrust_N"


def test_a_map_that_is_no_aerodynamics_flies_no_aircraft(tmp_path):
    with pytest.raises(NotExported, match="not a map of the 25 features to 12 coefficients"):
        export(MAP_RUN, "c", "airliner", None, tmp_path / "airliner.h")


@pytest.mark.parametrize(
    ("run", "to", "name", "said"),
    [
        ("nothing", "c", None, "nothing: no such run; allowed: a name below results/runs"),
        (WING_RUN, "c", "9 lives", "name: '9 lives' is not allowed; allowed: letters"),
    ],
)
def test_what_cannot_be_exported_is_said_in_a_line(run, to, name, said, tmp_path):
    with pytest.raises(NotExported, match=said) as refused:
        export(run, to, None, name, tmp_path / "file")
    assert len(str(refused.value).splitlines()) == 1
    assert not list(tmp_path.iterdir())


def test_an_fmu_without_a_compiler_is_refused(monkeypatch, tmp_path):
    monkeypatch.setenv("CC", "no-such-compiler")
    with pytest.raises(
        NotExported, match="--to fmu needs a C compiler, and there is none of no-such-compiler"
    ):
        export(WING_RUN, "fmu", None, None, tmp_path / "wing.fmu")


def test_onnx_without_its_package_is_refused(monkeypatch, tmp_path):
    monkeypatch.setitem(sys.modules, "onnx", None)
    with pytest.raises(
        NotExported, match=r"--to onnx needs the package onnx: pip install 'flexsurr\[export\]'"
    ):
        export(WING_RUN, "onnx", None, None, tmp_path / "wing.onnx")


def test_a_file_that_is_no_surrogate_is_refused(tmp_path):
    (tmp_path / "weights.npz").write_bytes(b"rubbish")
    with pytest.raises(SurrogateFileError, match="not a readable"):
        export(str(tmp_path), "c", None, None, tmp_path / "file.h")
