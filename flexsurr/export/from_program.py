"""The program of a torch module as expressions.

A program writes to addresses; here each address holds a number of a value, and writing puts another there.
"""

import numpy as np
from numpy.typing import NDArray

from flexsurr.export.expressions import (
    Value,
    concat,
    constant,
    each,
    matmul,
    reduced,
    scatter_add,
    solve,
    take,
    where,
)
from flexsurr.surrogates.program import CODES, ONE_OPERAND, TWO_OPERANDS, Program

NAMES = {code: name for name, code in CODES.items()}


class _Memory:
    """What lies at each address: a number of a value, or one that is known from the start."""

    def __init__(self, known: NDArray[np.float64]) -> None:
        self.known = known
        self.values: list[Value] = []
        self.holder = np.full(known.size, -1)
        self.place = np.zeros(known.size, dtype=np.int64)

    def write(self, addresses: NDArray[np.int64], value: Value) -> None:
        self.values.append(value)
        self.holder[addresses] = len(self.values) - 1
        self.place[addresses] = np.arange(addresses.size)

    def read(self, addresses: NDArray[np.int64]) -> Value:
        """The numbers at these addresses, in their shape."""
        holders = self.holder[addresses]
        parts, starts, size = [], {}, 0
        for holder in np.unique(holders).tolist():
            part = self.values[holder] if holder >= 0 else constant(self.known[addresses[holders < 0]])
            parts.append(part)
            starts[holder], size = size, size + part.size
        places = self.place[addresses] + np.vectorize(starts.__getitem__, otypes=[np.int64])(holders)
        if -1 in starts:  # the known ones were put together in the order in which they are read
            places[holders < 0] = starts[-1] + np.arange((holders < 0).sum())
        return take(concat(parts), places)


def outputs_of(program: Program, x: Value) -> Value:
    """The result (d,) of the program at `x` (d,)."""
    memory = _Memory(program.memory)
    memory.write(1 + np.arange(x.size), x)
    table = program.table
    for code, n, out, a, by_a, b, by_b, c, by_c in program.code.tolist():
        name, count = NAMES[code], np.arange(n)
        written = out + count
        first, second, third = (start + stride * count for start, stride in ((a, by_a), (b, by_b), (c, by_c)))
        if name == "matmul":
            left = memory.read(a + np.arange(n * by_a)).reshape(n, by_a)
            right = memory.read(b + np.arange(by_a * by_b)).reshape(by_a, by_b)
            result, written = matmul(left, right), out + np.arange(n * by_b)
        elif name == "gather":
            result = memory.read(table[a + count])
        elif name in ("sum", "amax"):
            result = reduced(name, memory.read(a + np.arange(n * by_a)).reshape(n, by_a))
        elif name == "scatter_add":
            into, places = np.unique(table[out + count], return_inverse=True)
            result, written = scatter_add(memory.read(into), places, memory.read(first)), into
        elif name == "where":
            result = where(memory.read(first), memory.read(second), memory.read(third))
        elif name == "solve":
            matrix = memory.read(a + np.arange(n * n)).reshape(n, n)
            written = out + np.arange(n * by_a)
            result = solve(matrix, memory.read(written).reshape(n, by_a))
        elif name in ONE_OPERAND:
            result = each(name, memory.read(first))
        elif name in TWO_OPERANDS:
            result = each(name, memory.read(first), memory.read(second))
        else:
            raise AssertionError(f"no expression of {name}")
        memory.write(written, result)
    return memory.read(program.result)
