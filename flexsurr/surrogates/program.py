"""A field as a list of instructions over one block of memory: any network compiled without a compiler.

The machine below is compiled once; what it runs is data. An instruction takes whole vectors, so that
reading it costs little beside doing it. `torch_program` writes programs from torch modules.
"""

import math
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from flexsurr.simulation.rhs import FLOATING_POINT, Array, implements_rhs

OPTIONS = {"fastmath": FLOATING_POINT, "error_model": "numpy", "_nrt": False}

OTHERS = ("gather", "matmul", "sum", "amax", "scatter_add", "where", "solve")
ONE_OPERAND = (
    "neg", "abs", "exp", "expm1", "log", "log1p", "sqrt", "rsqrt", "reciprocal", "sin", "cos", "tanh",
    "atan", "sigmoid", "erf", "relu",
)  # fmt: skip
TWO_OPERANDS = (
    "add", "sub", "mul", "div", "pow", "maximum", "minimum", "gt", "ge", "lt", "le", "eq", "ne",
)  # fmt: skip
CODES = {name: code for code, name in enumerate((*OTHERS, *ONE_OPERAND, *TWO_OPERANDS))}
"""The number of each instruction, by the name that torch has for it."""

(
    GATHER, MATMUL, SUM, AMAX, SCATTER_ADD, WHERE, SOLVE,
    NEG, ABS, EXP, EXPM1, LOG, LOG1P, SQRT, RSQRT, RECIPROCAL, SIN, COS, TANH, ATAN, SIGMOID, ERF, RELU,
    ADD, SUB, MUL, DIV, POW, MAXIMUM, MINIMUM, GT, GE, LT, LE, EQ, NE,
) = range(len(CODES))  # fmt: skip


class Program(NamedTuple):
    """Instructions (k, 9), addresses that they look up, memory, and where the result (d,) lies in it.

    Memory holds zero, the states (d,), then constants and what is computed. An instruction is a code, a
    length n, the address of its result, and up to three operands, each an address and a stride. In place of
    strides `matmul` has its other lengths, `sum` and `amax` the number of terms, `solve` of columns; the
    addresses that `gather` reads and `scatter_add` adds to are in the table. One thread at a time.
    """

    code: NDArray[np.int64]
    table: NDArray[np.int64]
    memory: Array
    result: NDArray[np.int64]


@njit(cache=True, **OPTIONS)
def _of_one(op, x):
    if op == TANH:
        return math.tanh(x)
    if op == EXP:
        return math.exp(x)
    if op == SIGMOID:
        return 1.0 / (1.0 + math.exp(-x))
    if op == LOG1P:
        return math.log1p(x)
    if op == NEG:
        return -x
    if op == ABS:
        return abs(x)
    if op == RECIPROCAL:
        return 1.0 / x
    if op == SQRT:
        return math.sqrt(x)
    if op == RSQRT:
        return 1.0 / math.sqrt(x)
    if op == SIN:
        return math.sin(x)
    if op == COS:
        return math.cos(x)
    if op == ATAN:
        return math.atan(x)
    if op == LOG:
        return math.log(x)
    if op == EXPM1:
        return math.expm1(x)
    if op == ERF:
        return math.erf(x)
    if op == RELU:
        return max(x, 0.0)
    return np.nan


@njit(cache=True, **OPTIONS)
def _of_two(op, x, y):
    if op == MUL:
        return x * y
    if op == ADD:
        return x + y
    if op == SUB:
        return x - y
    if op == DIV:
        return x / y
    if op == POW:
        return x**y
    if op == MAXIMUM:
        return max(x, y)
    if op == MINIMUM:
        return min(x, y)
    if op == GT:
        return 1.0 if x > y else 0.0
    if op == GE:
        return 1.0 if x >= y else 0.0
    if op == LT:
        return 1.0 if x < y else 0.0
    if op == LE:
        return 1.0 if x <= y else 0.0
    if op == EQ:
        return 1.0 if x == y else 0.0
    if op == NE:
        return 1.0 if x != y else 0.0
    return np.nan


@njit(cache=True, **OPTIONS)
def _multiply(m, out, a, b, rows, inner, columns):
    """(rows, inner) at a times (inner, columns) at b."""
    for i in range(rows):
        for j in range(columns):
            m[out + i * columns + j] = 0.0
        for k in range(inner):
            factor = m[a + i * inner + k]
            for j in range(columns):
                m[out + i * columns + j] += factor * m[b + k * columns + j]


@njit(cache=True, **OPTIONS)
def _solve(m, matrix, b, n, columns):
    """Overwrite b (n, columns) by the solution for the matrix (n, n), and that by its elimination."""
    for k in range(n):
        pivot = k
        for i in range(k + 1, n):
            if abs(m[matrix + i * n + k]) > abs(m[matrix + pivot * n + k]):
                pivot = i
        for j in range(n):
            p, q = matrix + k * n + j, matrix + pivot * n + j
            m[p], m[q] = m[q], m[p]
        for j in range(columns):
            p, q = b + k * columns + j, b + pivot * columns + j
            m[p], m[q] = m[q], m[p]
        for i in range(n):
            if i != k:
                factor = m[matrix + i * n + k] / m[matrix + k * n + k]
                for j in range(k, n):
                    m[matrix + i * n + j] -= factor * m[matrix + k * n + j]
                for j in range(columns):
                    m[b + i * columns + j] -= factor * m[b + k * columns + j]
    for i in range(n):
        for j in range(columns):
            m[b + i * columns + j] /= m[matrix + i * n + i]


@implements_rhs(Program, inline=False)
def _run(kernel, t, x, dx, work):
    code = kernel.code
    table = kernel.table
    m = kernel.memory
    for i in range(x.size):
        m[1 + i] = x[i]
    for row in range(code.shape[0]):
        op = code[row, 0]
        n = code[row, 1]
        out = code[row, 2]
        a = code[row, 3]
        by_a = code[row, 4]
        b = code[row, 5]
        by_b = code[row, 6]
        if op == MATMUL:
            _multiply(m, out, a, b, n, by_a, by_b)
        elif op == GATHER:
            for i in range(n):
                m[out + i] = m[table[a + i]]
        elif op in (SUM, AMAX):
            for i in range(n):
                total = m[a + i * by_a]
                for k in range(1, by_a):
                    value = m[a + i * by_a + k]
                    total = total + value if op == SUM else max(total, value)
                m[out + i] = total
        elif op == SCATTER_ADD:
            for i in range(n):
                m[table[out + i]] += m[a + i * by_a]
        elif op == WHERE:
            for i in range(n):
                chosen = b + i * by_b if m[a + i * by_a] != 0.0 else code[row, 7] + i * code[row, 8]
                m[out + i] = m[chosen]
        elif op == SOLVE:
            _solve(m, a, out, n, by_a)
        elif op < ADD:
            for i in range(n):
                m[out + i] = _of_one(op, m[a + i * by_a])
        else:
            for i in range(n):
                m[out + i] = _of_two(op, m[a + i * by_a], m[b + i * by_b])
    for i in range(x.size):
        dx[i] = m[kernel.result[i]]
