"""Arithmetic of a compiled right-hand side, counted: a cost that is the same on every machine.

The source of the equations is run once in Python, with numbers that count what is done with them. So the
count is that of the formulas as they stand: a compiler that finds a common term does less, and one that fills
whole vector registers does more.
"""

import builtins
import math
from collections.abc import Callable
from types import BuiltinFunctionType, CellType, CodeType, FunctionType
from typing import Any

import numpy as np
from numba import typeof, types
from numba.core.dispatcher import Dispatcher
from numba.core.typing.templates import builtin_registry

from flexsurr.simulation.mapping import CompiledMapping, mapping
from flexsurr.simulation.python_kernel import calls_python
from flexsurr.simulation.rhs import Array, CompiledModel, rhs

LIBRARY = 30
"""What a function of the C library counts for: what `surrogates.activations.exponential` takes, nearly."""

FREE = {"floor", "fabs", "abs", "isnan", "isfinite", "copysign"}
"""Functions that are no arithmetic; comparisons, signs and whole numbers are none either."""


def operations(model: CompiledModel, x: Array) -> int | None:
    """Additions, subtractions, products, quotients and roots of one right-hand side at the state `x` (d,).

    Each counts one, a function of the C library `LIBRARY`. None where the equations call Python, which cannot
    be counted.
    """
    return None if calls_python(model.kernel) else counted_rates(model, x)[1]


def counted_rates(model: CompiledModel, x: Array) -> tuple[Array, int]:
    """ẋ (d,) at time 0 and the state `x` (d,), as the source of the equations has it, and the operations."""
    return _counted(rhs, (model.kernel, 0.0), x, len(x), model.work_size)


def counted_outputs(function: CompiledMapping, u: Array) -> tuple[Array, int]:
    """The outputs (k,) of a mapping at the inputs `u` (n,), and the operations."""
    return _counted(mapping, (function.kernel,), u, len(function.output_names), function.work_size)


def in_python(function: Callable[..., Any]) -> Callable[..., Any]:
    """What compiled code calls by this name, such as `rhs` or `jacobian`, as Python for any numbers."""
    found: Callable[..., Any] = _Plain()(function)
    return found


def _counted(
    function: Callable[..., None], before: tuple[Any, ...], given: Array, size: int, work_size: int
) -> tuple[Array, int]:
    tally = Tally()
    written, work = (np.zeros(n, dtype=object) for n in (size, work_size))
    in_python(function)(*before, tally.numbers(given), written, work)
    return written.astype(float), tally.count


class Tally:
    """How many operations its numbers have taken part in."""

    def __init__(self) -> None:
        self.count = 0

    def numbers(self, values: Array) -> Any:
        """The values (n,) as numbers that count, an array of objects."""
        counted = np.empty(len(values), dtype=object)
        for k, value in enumerate(values.tolist()):
            counted[k] = Counted(value, self)
        return counted


class Counted:
    """A number, and the tally of what is done with it and with all that follows from it."""

    __slots__ = ("tally", "value")
    # NumPy's numbers leave an operation with one of these to it
    __array_ufunc__ = None

    def __init__(self, value: Any, tally: Tally) -> None:
        self.value, self.tally = value, tally

    def after(self, value: Any, count: int) -> "Counted":
        """What an operation that counts so many has made of it; whole numbers count nothing."""
        self.tally.count += 0 if isinstance(value, (int, np.integer)) else count
        return Counted(value, self.tally)

    def view(self, kind: Any) -> "Counted":
        """The same bits as a number of another kind."""
        return Counted(self.value.view(kind), self.tally)

    def __float__(self) -> float:
        return float(self.value)

    def __int__(self) -> int:
        return int(self.value)

    def __neg__(self) -> "Counted":
        return self.after(-self.value, 0)

    def __abs__(self) -> "Counted":
        return self.after(abs(self.value), 0)

    @property
    def real(self) -> "Counted":
        """The number itself."""
        return self


def _value(number: Any) -> Any:
    return number.value if isinstance(number, Counted) else number


def _arithmetic(name: str) -> None:
    def method(self: Counted, other: Any) -> Any:
        value, other = self.value, _value(other)
        found = getattr(value, name)(other)
        if found is NotImplemented:  # an integer on the left of a float
            found = getattr(float(value), name)(float(other))
        return self.after(found, 1)

    setattr(Counted, name, method)


def _comparison(name: str) -> None:
    setattr(Counted, name, lambda self, other: getattr(float(self.value), name)(float(_value(other))))


for _name in ("add", "sub", "mul", "truediv", "pow", "lshift", "rshift", "and"):
    _arithmetic(f"__{_name}__")
    _arithmetic(f"__r{_name}__")
for _name in ("lt", "le", "gt", "ge", "eq", "ne"):
    _comparison(f"__{_name}__")


class _Counting:
    """A module whose functions take numbers that count."""

    def __init__(self, module: Any) -> None:
        self._module = module

    def __getattr__(self, name: str) -> Any:
        found = getattr(self._module, name)
        return _CountingFunction(name, found) if callable(found) else found


class _CountingFunction:
    def __init__(self, name: str, original: Callable[..., Any]) -> None:
        self.original = original
        self._count = 0 if name in FREE else 1 if name == "sqrt" else LIBRARY
        if isinstance(original, type) and issubclass(original, np.generic):
            self._count, self.dtype = 0, np.dtype(original)  # NumPy takes this for the kind itself

    def __call__(self, *given: Any) -> Any:
        counted = next((each for each in given if isinstance(each, Counted)), None)
        value = self.original(*map(_value, given))
        return value if counted is None else counted.after(value, self._count)


def _overloads() -> dict[int, list[Callable[..., Any]]]:
    """What chooses the source of a function by the types of its arguments, by the function's identity."""
    found: dict[int, list[Callable[..., Any]]] = {}
    for function, kind in builtin_registry.globals:
        for template in getattr(kind, "templates", ()):
            if hasattr(template, "_overload_func"):
                found.setdefault(id(function), []).append(template._overload_func)
    return found


def _type_of(given: Any) -> Any:
    if isinstance(given, Counted):
        return types.float64
    if isinstance(given, np.ndarray) and given.dtype == object:
        return types.Array(types.float64, given.ndim, "C")
    return typeof(given)


class _Plain:
    """What compiled code calls, as functions of Python that may be given numbers that count."""

    def __init__(self) -> None:
        self._overloads = _overloads()
        self._made: dict[int, tuple[Any, Any]] = {}

    def __call__(self, thing: Any) -> Any:
        """The plain form of a compiled function, of a module, or of whatever else it is already plain."""
        if thing is math or thing is np:
            return _Counting(thing)
        if isinstance(thing, Dispatcher):
            return self(thing.py_func)
        if isinstance(thing, BuiltinFunctionType) and thing.__module__ == math.__name__:
            return _CountingFunction(thing.__name__, thing)
        if not isinstance(thing, FunctionType):
            return thing
        if id(thing) not in self._made:
            choices = self._overloads.get(id(thing))
            if choices:
                self._keep(thing, self._chosen(choices))
            else:
                self._rebuild(thing)
        return self._made[id(thing)][1]

    def _keep(self, thing: Any, plain: Any) -> None:
        """With the original too: what is gone leaves its identity to another."""
        self._made[id(thing)] = thing, plain

    def _chosen(self, choices: list[Callable[..., Any]]) -> Callable[..., Any]:
        sources: dict[tuple[Any, ...], Any] = {}

        def chosen(*given: Any) -> Any:
            kinds = tuple(map(_type_of, given))
            if kinds not in sources:
                sources[kinds] = self(next(found for choose in choices if (found := choose(*kinds))))
            return sources[kinds](*given)

        return chosen

    def _rebuild(self, function: FunctionType) -> None:
        names: dict[str, Any] = {"__builtins__": builtins}
        cells = function.__closure__ or ()
        closure = tuple(CellType() for _ in cells)
        code = function.__code__
        # kept before what it calls is looked at, which may call it
        self._keep(function, FunctionType(code, names, code.co_name, function.__defaults__, closure))
        for name in _names(code) & function.__globals__.keys():
            names[name] = self(function.__globals__[name])
        for cell, original in zip(closure, cells, strict=True):
            cell.cell_contents = self(original.cell_contents)


def _names(code: CodeType) -> set[str]:
    """The names that some code, and the functions within it, look up."""
    inner = [constant for constant in code.co_consts if isinstance(constant, CodeType)]
    return set(code.co_names).union(*map(_names, inner))
