"""Functions as expressions: what every exported form is printed from.

A value is an operation on other values, with a shape that is known; formulas are written with Python's
operators as they are in NumPy. What only moves numbers (slices, broadcasts, transposes) is one operation,
`take`, by indices that are known too. The printers therefore have few operations to know.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from flexsurr.surrogates.activations import Function, Functions, formulas
from flexsurr.surrogates.program import ONE_OPERAND, TWO_OPERANDS

EACH = (*ONE_OPERAND, *TWO_OPERANDS, "atan2", "asin")


@dataclass(frozen=True, eq=False)
class Value:
    """An operation on operands, of a shape; numbers lie in C's order.

    Operations: input, constant, reshape, take, concat; those of `EACH`; sum, amax; matmul, where,
    scatter_add, solve.

    `detail` is what else the operation needs: an input's name, a constant's numbers, the indices of `take`
    and `scatter_add` into the operand's numbers in their order, the number of terms of `sum` and `amax`
    (which run over the last axis), the (rows, inner, columns) of `matmul`, the columns of `solve`.
    """

    operation: str
    operands: tuple["Value", ...]
    shape: tuple[int, ...]
    detail: Any = None

    # NumPy's arrays leave an operation with a value to it
    __array_ufunc__ = None

    @property
    def size(self) -> int:
        """How many numbers it holds."""
        return int(np.prod(self.shape, dtype=int))

    def __add__(self, other: Any) -> "Value":
        return each("add", self, other)

    def __radd__(self, other: Any) -> "Value":
        return each("add", other, self)

    def __sub__(self, other: Any) -> "Value":
        return each("sub", self, other)

    def __rsub__(self, other: Any) -> "Value":
        return each("sub", other, self)

    def __mul__(self, other: Any) -> "Value":
        return each("mul", self, other)

    def __rmul__(self, other: Any) -> "Value":
        return each("mul", other, self)

    def __truediv__(self, other: Any) -> "Value":
        return each("div", self, other)

    def __rtruediv__(self, other: Any) -> "Value":
        return each("div", other, self)

    def __pow__(self, power: int) -> "Value":
        if power != 2:
            raise ValueError(f"of powers there is the square alone, not {power}")
        return each("mul", self, self)

    def __neg__(self) -> "Value":
        return each("neg", self)

    def __abs__(self) -> "Value":
        return each("abs", self)

    def __matmul__(self, other: Any) -> "Value":
        return matmul(self, other)

    def __rmatmul__(self, other: Any) -> "Value":
        return matmul(other, self)

    def __getitem__(self, key: Any) -> "Value":
        return take(self, np.arange(self.size).reshape(self.shape)[key])

    @property
    def T(self) -> "Value":
        """Axes in the opposite order."""
        return take(self, np.arange(self.size).reshape(self.shape).T)

    def reshape(self, *shape: int) -> "Value":
        """The same numbers in another shape."""
        known = np.empty(self.shape).reshape(shape).shape
        if self.operation == "constant":
            return constant(self.detail.reshape(known))
        return self if known == self.shape else Value("reshape", (self,), known)

    def sum(self) -> "Value":
        """The sum over the last axis."""
        return reduced("sum", self)


def argument(name: str, size: int) -> Value:
    """The vector (size,) of this name that a function is given."""
    return Value("input", (), (size,), name)


def constant(numbers: Any) -> Value:
    """Numbers that are known."""
    array = np.array(numbers, dtype=np.float64)
    return Value("constant", (), array.shape, array)


def value(given: Any) -> Value:
    """`given`, a constant where it is numbers."""
    return given if isinstance(given, Value) else constant(given)


def each(operation: str, *operands: Any) -> Value:
    """An operation number by number, its operands broadcast as NumPy does."""
    values = [value(operand) for operand in operands]
    shape = np.broadcast_shapes(*(operand.shape for operand in values))
    return Value(operation, tuple(_broadcast(operand, shape) for operand in values), shape)


def where(condition: Value, chosen: Any, other: Any) -> Value:
    """`chosen` where the condition is not 0, else `other`."""
    return each("where", condition, chosen, other)


def take(whole: Value, indices: Any) -> Value:
    """The numbers of `whole` at these places in their order, in the indices' shape."""
    indices = np.asarray(indices, dtype=np.int64)
    if whole.operation == "constant":
        return constant(whole.detail.reshape(-1)[indices])
    if whole.operation == "reshape":
        return take(whole.operands[0], indices)
    if whole.operation == "take":
        return take(whole.operands[0], whole.detail.reshape(-1)[indices])
    if indices.size == whole.size and np.array_equal(indices.reshape(-1), np.arange(whole.size)):
        return whole.reshape(*indices.shape)
    return Value("take", (whole,), indices.shape, indices)


def concat(values: Sequence[Any]) -> Value:
    """All numbers one after the other, (n,)."""
    parts = tuple(part for part in map(value, values) if part.size)
    if len(parts) == 1:
        return parts[0].reshape(-1)
    return Value("concat", parts, (sum(part.size for part in parts),))


def matmul(a: Any, b: Any) -> Value:
    """The product of matrices or vectors, of one or two axes each."""
    first, second = value(a), value(b)
    shape = (np.zeros(first.shape) @ np.zeros(second.shape)).shape  # what is not written may overflow
    inner = first.shape[-1]
    return Value("matmul", (first, second), shape, (first.size // inner, inner, second.size // inner))


def reduced(operation: str, whole: Value) -> Value:
    """The `sum` or the largest, `amax`, over the last axis."""
    return Value(operation, (whole,), whole.shape[:-1], whole.shape[-1])


def scatter_add(base: Value, indices: Any, added: Value) -> Value:
    """`base` with each number added at its place in it; a place may occur more than once."""
    return Value("scatter_add", (base, added), base.shape, np.asarray(indices, dtype=np.int64).reshape(-1))


def solve(matrix: Value, right: Value) -> Value:
    """X of A X = B, (n, n) and (n,) or (n, k), by elimination with pivots."""
    return Value("solve", (matrix, right), right.shape, right.size // matrix.shape[0])


def logistic(z: Value) -> Value:
    """1 / (1 + e⁻ᶻ), which overflows nowhere."""
    return 0.5 + 0.5 * each("tanh", 0.5 * z)


def activation(name: str) -> tuple[Function, Function]:
    """σ and σ′ of values."""
    of_value, of_slope, _ = _FORMULAS[name]
    return of_value, of_slope


def ordered(results: Iterable[Value]) -> list[Value]:
    """Every value that `results` need, operands first, each once."""
    found: dict[int, Value] = {}
    pending = [(result, False) for result in reversed(list(results))]
    while pending:
        current, ready = pending.pop()
        if id(current) in found:
            continue
        if ready:
            found[id(current)] = current
        else:
            pending.append((current, True))
            pending += [(operand, False) for operand in reversed(current.operands)]
    return list(found.values())


def _broadcast(operand: Value, shape: tuple[int, ...]) -> Value:
    if operand.size == 1 or operand.size == int(np.prod(shape, dtype=int)):
        return operand
    return take(operand, np.broadcast_to(np.arange(operand.size).reshape(operand.shape), shape))


def _one(operation: str) -> Any:
    return lambda z: each(operation, z)


_FORMULAS = formulas(
    Functions(
        exp=_one("exp"),
        log=_one("log"),
        sqrt=_one("sqrt"),
        atan=_one("atan"),
        tanh=_one("tanh"),
        logistic=logistic,
        above=lambda z: each("maximum", z, 0.0),
        below=lambda z: each("minimum", z, 0.0),
    )
)
