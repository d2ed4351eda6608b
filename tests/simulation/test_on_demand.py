"""Machine code is made of what Python calls, and of nothing else; whatever asks for it, gets it."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from numba import cfunc, njit, types, vectorize
from numba.extending import overload

import flexsurr.simulation  # noqa: F401 (from here on numba translates on demand)

REPOSITORY = Path(__file__).parents[2]

MODULE = """
from numba import njit
import flexsurr.simulation

@njit(cache=True)
def inner(x):
    return x + 1.0

@njit(cache=True)
def outer(x):
    return 2.0 * inner(x)

def hits(function):
    return sum(function.stats.cache_hits.values())
"""


def pair():
    """A function and one that calls it, neither of which has been compiled."""

    @njit
    def inner(x):
        if x < 0.0:
            raise ValueError("negative")
        return x + 1.0

    @njit
    def outer(x):
        return 2.0 * inner(x)

    return inner, outer


def translated(function):
    (found,) = function.overloads.values()
    return found.library.translated


def test_what_is_called_from_machine_code_alone_has_none_of_its_own():
    inner, outer = pair()
    assert outer(1.0) == 4.0
    assert translated(outer)
    assert not translated(inner)


def test_when_python_calls_it_too_it_gets_machine_code():
    inner, outer = pair()
    assert outer(1.0) == 4.0
    assert inner(1.0) == 2.0
    assert translated(inner)
    assert outer(2.0) == 6.0


def test_an_error_within_reaches_python():
    _, outer = pair()
    with pytest.raises(ValueError, match="negative"):
        outer(-1.0)


def test_python_may_call_it_while_another_function_is_compiled():
    inner, outer = pair()
    assert outer(1.0) == 4.0

    def shifted(x):
        raise NotImplementedError

    @overload(shifted)
    def resolve(x):
        shift = inner(1.0)
        return lambda x: x + shift

    @njit
    def calls(x):
        return shifted(x)

    assert calls(1.0) == 3.0


def test_whoever_asks_for_an_address_gets_one():
    inner, outer = pair()
    assert outer(1.0) == 4.0

    @cfunc(types.float64(types.float64))
    def of_c(x):
        return inner(x)

    @vectorize([types.float64(types.float64)])
    def of_arrays(x):
        return inner(x)

    @njit
    def of_values(x):
        total = 0.0
        for function in (inner, inner):
            total += function(x)
        return total

    assert of_c.ctypes(1.0) == 2.0
    np.testing.assert_array_equal(of_arrays(np.arange(3.0)), np.arange(1.0, 4.0))
    assert of_values(1.0) == 4.0


def test_in_the_next_process_both_are_found(tmp_path):
    (tmp_path / "called.py").write_text(MODULE)
    kept = {k: v for k, v in os.environ.items() if k != "NUMBA_CACHE_DIR"}
    environment = {**kept, "NUMBA_CACHE_DIR": str(tmp_path), "PYTHONPATH": f"{tmp_path}:{REPOSITORY}"}

    def say(code):
        command = [sys.executable, "-c", f"from called import *; {code}"]
        return subprocess.run(command, env=environment, check=True, capture_output=True, text=True).stdout

    assert say("print(outer(1.0), hits(outer))") == "4.0 0\n"
    # kept for others it is no machine code, and is compiled once more
    assert say("print(inner(1.0), hits(inner), outer(1.0), hits(outer))") == "2.0 0 4.0 1\n"
    assert say("print(inner(1.0), hits(inner), outer(1.0), hits(outer))") == "2.0 1 4.0 1\n"
    # for other types the outer function is new, and links the inner one
    assert say("print(outer(1), outer(1.0), hits(inner))") == "4.0 4.0 0\n"
