"""Equations in Python as a kernel: compiled integrators step them too, at the cost of a call each time."""

import ctypes
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from llvmlite import ir
from numba import types
from numba.extending import intrinsic

from flexsurr.simulation.rhs import Array, implements_rhs


class PythonKernel(NamedTuple):
    """The address of a C function without arguments; where it finds x (d,), and where it leaves dx (d,)."""

    address: int
    x: Array
    dx: Array


class PythonEquations:
    """An autonomous right-hand side in Python, x (d,) -> dx (d,), and its `kernel`.

    The kernel is good for as long as this object lives, and for one thread at a time. An Exception makes the
    rates not a number, by which the simulation ends; anything else waits for `raise_pending`.
    """

    def __init__(self, states: int, derivative: Callable[[Array], Array]) -> None:
        x, dx = np.empty(states), np.empty(states)

        def call() -> None:
            dx[:] = np.nan
            if _pending:
                return
            try:
                dx[:] = derivative(x)
            except Exception:
                return
            except BaseException as stop:  # Ctrl-C, which C code would pass over
                _pending.append(stop)

        self._function = ctypes.CFUNCTYPE(None)(call)
        address = ctypes.cast(self._function, ctypes.c_void_p).value
        assert address is not None
        self.kernel = PythonKernel(address, x, dx)


_pending: list[BaseException] = []


def raise_pending() -> None:
    """Raise what ended Python while compiled code was calling it: it had to wait until that returned."""
    if _pending:
        raise _pending.pop()


def calls_python(kernel: object) -> bool:
    """Whether Python is called by `kernel`, or by a kernel within it."""
    return isinstance(kernel, PythonKernel) or (
        isinstance(kernel, tuple) and any(calls_python(part) for part in kernel)
    )


@intrinsic
def _call(context, address):
    """Call the C function without arguments at `address`."""

    def generate(context, builder, signature, arguments):
        function = ir.FunctionType(ir.VoidType(), [])
        builder.call(builder.inttoptr(arguments[0], function.as_pointer()), [])
        return context.get_dummy_value()

    return types.void(types.int64), generate


@implements_rhs(PythonKernel, inline=False)
def _python(kernel, t, x, dx, work):
    for i in range(x.size):
        kernel.x[i] = x[i]
    _call(kernel.address)
    for i in range(x.size):
        dx[i] = kernel.dx[i]
