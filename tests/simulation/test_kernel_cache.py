"""Machine code outlives its process, and not the sources it came from."""

import errno
import fcntl
import json
import multiprocessing
import os
import shutil
import subprocess
import sys
import threading
import time
from importlib import import_module
from pathlib import Path

import pytest
from numba.core.caching import IndexDataCacheFile

from flexsurr import kernel_cache
from flexsurr.simulation import machine_code

HERE = Path(__file__).parent
REPOSITORY = HERE.parents[1]
PREFIX = "flexsurr-kernels-"

EVERY_METHOD = """
import json
import numpy as np
from flexsurr.config.study import Integrator
from flexsurr.simulation import adaptive_explicit, fixed_step, radau, simulate
from flexsurr.simulation.closed_form_problems import OSCILLATOR, planar
for method in ("rk4", "dop853_fixed", "gauss_legendre_4", "gauss_legendre_6", "dop853", "radau_iia_5"):
    settings = {} if method in ("dop853", "radau_iia_5") else {"step_s": 0.01}
    integrator = Integrator(method=method, **settings)
    assert simulate(planar(OSCILLATOR, 1.0), np.array([0.0, 1.0]), np.ones(2), integrator).completed
compiled = (fixed_step.run_fixed_step, adaptive_explicit.run_dop853, radau.run_radau)
print(json.dumps({"hits": sum(sum(f.stats.cache_hits.values()) for f in compiled),
                  "misses": sum(sum(f.stats.cache_misses.values()) for f in compiled)}))
"""


class Refused(Exception):
    """A process ended with an error; holds what it said."""


def run(code, *path, **environment):
    kept = {k: v for k, v in os.environ.items() if k not in ("NUMBA_CACHE_DIR", "PYTHONPATH")}
    done = subprocess.run(
        [sys.executable, "-c", code],
        cwd=path[0] if path else HERE,  # Python looks there first
        env={**kept, "PYTHONPATH": os.pathsep.join(map(str, (*path, REPOSITORY))), **environment},
        capture_output=True,
        text=True,
        check=False,
    )
    if done.returncode:
        raise Refused(done.stderr)
    return done.stdout


def code_file(folder):
    """Where numba keeps the machine code of one function, in a process that has flexsurr's kernels."""
    import_module("flexsurr.simulation.rhs")
    return IndexDataCacheFile(str(folder), "kernel", "stamp")


@pytest.mark.parametrize("moment", ["_save_data", "_save_index"])
def test_two_processes_that_compile_at_once_do_not_run_each_others_code(tmp_path, moment):
    """Both have read the index before either writes it, and one writes in the middle of the other."""
    first, second, reader = (code_file(tmp_path) for _ in range(3))
    first._load_index = second._load_index = dict
    whole = getattr(first, moment)

    def interrupted(*arguments):
        second.save("b", "code of b")
        whole(*arguments)

    setattr(first, moment, interrupted)
    first.save("a", "code of a")
    assert reader.load("a") in ("code of a", None)
    assert reader.load("b") in ("code of b", None)
    reader.save("a", "code of a")
    reader.save("b", "code of b")
    assert (reader.load("a"), reader.load("b")) == ("code of a", "code of b")


def test_the_code_is_there_before_the_index_leads_to_it(tmp_path, monkeypatch):
    """A process killed in between leaves no entry without code."""
    file = code_file(tmp_path)

    def killed(data):
        raise KeyboardInterrupt

    monkeypatch.setattr(file, "_save_index", killed)
    with pytest.raises(KeyboardInterrupt):
        file.save("a", "code of a")
    assert len(list(tmp_path.glob("*.nbc"))) == 1
    assert code_file(tmp_path).load("a") is None


ONE_METHOD = """
import numpy as np
from flexsurr.config.study import Integrator
from flexsurr.simulation import fixed_step, simulate
from flexsurr.simulation.closed_form_problems import OSCILLATOR, planar
method = Integrator(method=METHOD, step_s=0.01)
assert simulate(planar(OSCILLATOR, 1.0), np.array([0.0, 1.0]), np.ones(2), method).completed
print(sum(fixed_step.run_fixed_step.stats.cache_misses.values()))
"""


def one_method(name):
    return ONE_METHOD.replace("METHOD", repr(name))


def test_of_two_processes_that_need_the_same_code_one_compiles_it(tmp_path):
    code = one_method("rk4")
    path = os.pathsep.join(map(str, (HERE, REPOSITORY)))
    environment = os.environ | {"NUMBA_CACHE_DIR": str(tmp_path), "PYTHONPATH": path}
    both = [
        subprocess.Popen([sys.executable, "-c", code], cwd=HERE, env=environment, stdout=subprocess.PIPE)
        for _ in range(2)
    ]
    assert sorted(int(process.communicate(timeout=120)[0]) for process in both) == [0, 1]


def test_equations_are_compiled_once_for_all_integrators(tmp_path):
    for name in ("rk4", "gauss_legendre_4"):
        assert run(one_method(name), HERE, NUMBA_CACHE_DIR=str(tmp_path)).strip() == "1"
    assert len(list(tmp_path.rglob("closed_form_problems._planar-*.nbc"))) == 1


A_SCRIPT = """
from typing import NamedTuple
import numpy as np
from flexsurr.simulation.rhs import evaluate, implements_rhs
class Mine(NamedTuple):
    rate: float
@implements_rhs(Mine)
def _mine(kernel, t, x, dx, work):
    dx[0] = kernel.rate
dx = np.empty(1)
evaluate(Mine(2.0), 0.0, dx, dx, dx)
print(dx[0])
"""


def test_the_kernel_of_a_script_is_compiled_in_each_process(tmp_path):
    said = [run(A_SCRIPT, NUMBA_CACHE_DIR=str(tmp_path)) for _ in range(2)]
    assert said == ["2.0\n", "2.0\n"]


def _compiling(folder, name, said):
    with machine_code._locked(folder, name):
        said.send("begun")
        time.sleep(60)


@pytest.mark.filterwarnings("ignore:.*fork.*:DeprecationWarning")  # of Python 3.12: nothing here holds a lock
def test_what_another_process_compiles_is_waited_for_or_left_to_it(tmp_path):
    listens, says = multiprocessing.Pipe()
    compiling = multiprocessing.get_context("fork").Process(
        target=_compiling, args=(str(tmp_path), "a", says)
    )
    compiling.start()
    assert listens.recv() == "begun"
    with machine_code._locked(str(tmp_path), "b"):
        pass  # something else
    with (
        machine_code.unless_compiled_elsewhere(),
        pytest.raises(machine_code.CompiledElsewhere),
        machine_code._locked(str(tmp_path), "a"),
    ):
        pass
    threading.Timer(0.2, compiling.kill).start()
    with machine_code._locked(str(tmp_path), "a"):  # a killed process compiles no longer
        assert compiling.exitcode is None or compiling.exitcode < 0
    compiling.join()


def test_without_locks_each_compiles_for_itself(tmp_path, monkeypatch):
    def refuse(*arguments):
        raise OSError(errno.ENOLCK, "no locks available")

    monkeypatch.setattr(fcntl, "lockf", refuse)
    with machine_code._locked(str(tmp_path), "a"):
        pass


def test_the_next_process_compiles_nothing():
    run(EVERY_METHOD)
    assert json.loads(run(EVERY_METHOD)) == {"hits": 6, "misses": 0}


def test_an_edit_of_equations_takes_effect(tmp_path):
    """Numba alone would keep the old ones: it looks at the file of `evaluate` only."""
    package = tmp_path / "flexsurr"
    shutil.copytree(kernel_cache.PACKAGE, package, ignore=shutil.ignore_patterns("__pycache__"))
    equations = package / "aerodynamics" / "constant.py"
    equations.parent.mkdir(exist_ok=True)
    (equations.parent / "__init__.py").touch()
    source = """
from typing import NamedTuple
from flexsurr.simulation.rhs import implements_rhs
class Constant(NamedTuple):
    pass
@implements_rhs(Constant)
def _constant(kernel, t, x, dx, work):
    dx[0] = VALUE
"""
    ask = """
import numpy as np
from flexsurr.aerodynamics.constant import Constant
from flexsurr.simulation.rhs import evaluate
dx = np.empty(1)
evaluate(Constant(), 0.0, np.ones(1), dx, np.empty(0))
print(dx[0], sum(evaluate.stats.cache_hits.values()))
"""
    equations.write_text(source.replace("VALUE", "1.0"))
    assert run(ask, tmp_path).split() == ["1.0", "0"]
    assert run(ask, tmp_path).split() == ["1.0", "1"]
    equations.write_text(source.replace("VALUE", "2.0"))
    assert run(ask, tmp_path).split() == ["2.0", "0"]


def test_numba_uses_the_folder_also_if_it_came_first():
    shown = run(
        "import numba, flexsurr, os; print(numba.config.CACHE_DIR); print(os.environ['NUMBA_CACHE_DIR'])"
    )
    first, second = shown.split()
    assert first == second
    assert Path(first).name == PREFIX + kernel_cache.digest()


def test_importing_the_package_does_not_import_numba():
    assert run("import sys, flexsurr; print('numba' in sys.modules)").strip() == "False"


def test_the_users_choice_stands(tmp_path):
    ask = "import flexsurr, os; print(os.environ['NUMBA_CACHE_DIR'])"
    assert run(ask, NUMBA_CACHE_DIR=str(tmp_path)).strip() == str(tmp_path)


def test_a_parents_choice_does_not_stand(tmp_path):
    ask = "import flexsurr, os; print(os.environ['NUMBA_CACHE_DIR'])"
    inherited = str(tmp_path / (PREFIX + "0123456789abcdef"))
    assert Path(run(ask, NUMBA_CACHE_DIR=inherited).strip()).name == PREFIX + kernel_cache.digest()


def test_kernels_from_outside_need_a_folder_of_their_own(tmp_path):
    (tmp_path / "mine.py").write_text(
        "from typing import NamedTuple\n"
        "from flexsurr.simulation import implements_rhs\n"
        "class Mine(NamedTuple):\n    pass\n"
        "@implements_rhs(Mine)\ndef _mine(kernel, t, x, dx, work):\n    dx[0] = 1.0\n"
    )
    with pytest.raises(Refused) as refused:
        run("import mine", tmp_path)
    assert "Mine is defined outside flexsurr: call flexsurr.kernel_cache.activate" in str(refused.value)
    run("import mine", tmp_path, NUMBA_CACHE_DIR=str(tmp_path))
    activate = f"from flexsurr import kernel_cache; kernel_cache.activate({str(tmp_path / 'mine.py')!r}); "
    run(activate + "import mine", tmp_path)
    with pytest.raises(Refused) as late:
        run("import flexsurr.simulation; " + activate, tmp_path)
    assert "before importing flexsurr.simulation" in str(late.value)


@pytest.fixture
def package(tmp_path, monkeypatch):
    """A package of one kernel; whatever `activate` sets is undone."""
    monkeypatch.setenv("NUMBA_CACHE_DIR", "")
    monkeypatch.setattr("numba.config.CACHE_DIR", "")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    (tmp_path / "package" / "beam").mkdir(parents=True)
    (tmp_path / "package" / "beam" / "sweep.py").write_text("ONE = 1\n")
    return tmp_path / "package"


def chosen(package):
    kernel_cache.activate(package=package)
    return Path(os.environ["NUMBA_CACHE_DIR"])


def test_the_folder_follows_the_sources(package):
    first = chosen(package)
    assert first.parent == package / "__pycache__"
    assert chosen(package) == first
    (package / "beam" / "sweep.py").write_text("ONE = 2\n")
    second = chosen(package)
    (package / "beam" / "sweep.py").rename(package / "beam" / "other.py")
    assert len({first, second, chosen(package)}) == 3
    (package / "beam" / "other.py").rename(package / "beam" / "sweep.py")
    assert chosen(package) == second


def test_a_package_that_cannot_be_written_to_uses_the_users_cache(package, tmp_path):
    (package / "__pycache__").write_text("in the way")
    assert chosen(package).parent == tmp_path / "cache" / "flexsurr"


def test_the_last_resort_is_a_temporary_folder(package, tmp_path, monkeypatch):
    (package / "__pycache__").write_text("in the way")
    (tmp_path / "cache").write_text("in the way")
    monkeypatch.setattr(Path, "home", lambda: tmp_path / "cache")
    folder = chosen(package)
    assert folder.is_dir()
    folder.rmdir()


def test_folders_unused_for_long_are_removed_when_a_new_one_is_made(package):
    old = chosen(package)
    recent = package / "__pycache__" / (PREFIX + "recent")
    recent.mkdir()
    (old / "code.nbc").write_text("")
    long_ago = time.time() - (kernel_cache.KEPT_UNUSED_DAYS + 1) * 86400
    os.utime(old, (long_ago, long_ago))
    (package / "beam" / "sweep.py").write_text("ONE = 2\n")
    new = chosen(package)
    assert {path.name for path in (package / "__pycache__").iterdir()} == {new.name, recent.name}
