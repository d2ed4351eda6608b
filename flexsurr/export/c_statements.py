"""Expressions as statements of C99."""

import textwrap
from collections import Counter
from collections.abc import Sequence

import numpy as np

from flexsurr.export.expressions import EACH, Value, ordered

FUNCTIONS = {
    "add": "{0} + {1}", "sub": "{0} - {1}", "mul": "{0} * {1}", "div": "{0} / {1}", "neg": "-{0}",
    "pow": "pow({0}, {1})", "atan2": "atan2({0}, {1})", "asin": "asin({0})", "abs": "fabs({0})",
    "exp": "exp({0})", "expm1": "expm1({0})", "log": "log({0})", "log1p": "log1p({0})",
    "sqrt": "sqrt({0})", "rsqrt": "1.0 / sqrt({0})", "reciprocal": "1.0 / {0}", "sin": "sin({0})",
    "cos": "cos({0})", "tanh": "tanh({0})", "atan": "atan({0})", "erf": "erf({0})",
    "sigmoid": "0.5 + 0.5 * tanh(0.5 * {0})",
    "gt": "(double)({0} > {1})", "ge": "(double)({0} >= {1})", "lt": "(double)({0} < {1})",
    "le": "(double)({0} <= {1})", "eq": "(double)({0} == {1})", "ne": "(double)({0} != {1})",
    "maximum": "{prefix}_larger({0}, {1})", "minimum": "-{prefix}_larger(-{0}, -{1})",
    "relu": "{prefix}_larger({0}, 0.0)", "where": "{0} != 0.0 ? {1} : {2}",
}  # fmt: skip
"""Operations number by number; whatever stands for an operand is a name, a call, or in brackets."""

HELPERS = {
    "larger": """\
static inline double {prefix}_larger(double a, double b)
{{
    return a < b ? b : a;
}}
""",
    "product": """\
/* (rows, inner) times (inner, columns) */
static inline void {prefix}_product(int rows, int inner, int columns, const double *a, const double *b,
                                    double *out)
{{
    for (int i = 0; i < rows; i++) {{
        for (int j = 0; j < columns; j++)
            out[i * columns + j] = 0.0;
        for (int k = 0; k < inner; k++)
            for (int j = 0; j < columns; j++)
                out[i * columns + j] += a[i * inner + k] * b[k * columns + j];
    }}
}}
""",
    "solve": """\
/* overwrites b (n, columns) by the solution for the matrix (n, n), and that by its elimination */
static inline void {prefix}_solve(int n, int columns, double *a, double *b)
{{
    for (int k = 0; k < n; k++) {{
        int pivot = k;
        for (int i = k + 1; i < n; i++)
            if (fabs(a[i * n + k]) > fabs(a[pivot * n + k]))
                pivot = i;
        for (int j = 0; j < n; j++) {{
            const double kept = a[k * n + j];
            a[k * n + j] = a[pivot * n + j];
            a[pivot * n + j] = kept;
        }}
        for (int j = 0; j < columns; j++) {{
            const double kept = b[k * columns + j];
            b[k * columns + j] = b[pivot * columns + j];
            b[pivot * columns + j] = kept;
        }}
        for (int i = 0; i < n; i++) {{
            if (i == k)
                continue;
            const double factor = a[i * n + k] / a[k * n + k];
            for (int j = k; j < n; j++)
                a[i * n + j] -= factor * a[k * n + j];
            for (int j = 0; j < columns; j++)
                b[i * columns + j] -= factor * b[k * columns + j];
        }}
    }}
    for (int i = 0; i < n; i++)
        for (int j = 0; j < columns; j++)
            b[i * columns + j] /= a[i * n + i];
}}
""",
}
WIDTH = 100
LONGEST = 60
"""Characters of an expression that is still written where it is used."""

BY_NUMBER = (*EACH, "where")


def affine(indices: np.ndarray) -> tuple[int, int] | None:
    """The first of these indices and the step between them; None where steps differ."""
    flat = indices.reshape(-1)
    steps = np.unique(np.diff(flat))
    if len(steps) > 1:
        return None
    return int(flat[0]), int(steps[0]) if len(steps) else 1


class Statements:
    """The statements of a function that compute a value; the arrays of its inputs bear their names.

    Operations number by number are written into the one that uses them, if that is one alone.
    `helpers` collects which of `HELPERS` they call.
    """

    def __init__(self, prefix: str) -> None:
        self.prefix = prefix
        self.helpers: set[str] = set()
        self._lines: list[str] = []
        self._arrays: dict[int, str] = {}
        self._written: dict[int, str] = {}
        self._fusable: set[int] = set()
        self._names = 0

    def of(self, value: Value, name: str) -> list[str]:
        """Lines that write `value` to the array `name`."""
        values = ordered([value])
        self._lines, self._arrays, self._written, self._names = [], {}, {}, 0
        self._fusable = _fusable(values)
        for each in values:
            if each.operation == "input":
                self._arrays[id(each)] = each.detail
            if each is value:
                self._write(each, name)
            elif each.operation in BY_NUMBER:
                expression = self._expression(each)
                if id(each) in self._fusable and len(expression) <= LONGEST:
                    self._written[id(each)] = expression
                else:
                    self._declare(each)
            elif not _in_place(each):
                self._declare(each)
        return self._lines

    def _new(self, letter: str) -> str:
        self._names += 1
        return f"{letter}{self._names}"

    def _declare(self, value: Value) -> str:
        """The name of a new array that holds `value`."""
        name = self._new("c" if value.operation == "constant" else "v")
        if value.operation == "constant":
            numbers = [repr(number) for number in value.detail.reshape(-1).tolist()]
            self._lines += _table("double", name, numbers)
        else:
            self._lines.append(f"double {name}[{value.size}];")
            self._write(value, name)
        self._arrays[id(value)] = name
        return name

    def _write(self, value: Value, name: str) -> None:
        """Statements that fill the array `name`, which is there."""
        operands = value.operands
        if value.operation in BY_NUMBER:
            self._each(name, 0, value.size, self._expression(value))
        elif value.operation == "concat":
            start = 0
            for part in operands:
                self._each(name, start, part.size, self._element(part))
                start += part.size
        elif value.operation == "matmul":
            self._call("product", *value.detail, *map(self._address, operands), name)
        elif value.operation in ("sum", "amax"):
            self._reduce(name, value)
        elif value.operation == "scatter_add":
            before, added = operands
            table = self._indices(value.detail)
            self._each(name, 0, before.size, self._element(before))
            self._lines.append(
                f"for (int i = 0; i < {added.size}; i++) {name}[{table}[i]] += {self._element(added)};"
            )
        elif value.operation == "solve":
            matrix, right = operands
            copy = self._new("a")
            self._lines.append(f"double {copy}[{matrix.size}];")
            self._each(copy, 0, matrix.size, self._element(matrix))
            self._each(name, 0, right.size, self._element(right))
            self._call("solve", matrix.shape[0], value.detail, copy, name)
        elif value.operation == "take" and not _in_place(value):
            (first, offset), table = self._base(operands[0]), self._indices(value.detail)
            place = f"{offset} + {table}[i]" if offset else f"{table}[i]"
            self._each(name, 0, value.size, f"{first}[{place}]")
        else:
            self._each(name, 0, value.size, self._element(value))

    def _each(self, name: str, first: int, count: int, expression: str) -> None:
        if count == 1:
            self._lines.append(f"{name}[{first}] = {expression.replace('[i]', '[0]')};")
        elif count:
            place = f"{first} + i" if first else "i"
            self._lines.append(f"for (int i = 0; i < {count}; i++) {name}[{place}] = {expression};")

    def _reduce(self, name: str, value: Value) -> None:
        whole, terms = self._address(value.operands[0]), value.detail
        base = f"({whole})" if "+" in whole else whole
        joined = "{0} + {1}" if value.operation == "sum" else FUNCTIONS["maximum"]
        if value.operation == "amax":
            self.helpers.add("larger")
        step = joined.format(f"{name}[i]", f"{base}[i * {terms} + k]", prefix=self.prefix)
        self._lines += [
            f"for (int i = 0; i < {value.size}; i++) {{",
            f"    {name}[i] = {base}[i * {terms}];",
            f"    for (int k = 1; k < {terms}; k++) {name}[i] = {step};",
            "}",
        ]

    def _call(self, helper: str, *arguments: object) -> None:
        self.helpers.add(helper)
        self._lines.append(f"{self.prefix}_{helper}({', '.join(map(str, arguments))});")

    def _expression(self, value: Value) -> str:
        """The number i of an operation number by number."""
        template = FUNCTIONS[value.operation]
        if "_larger" in template:
            self.helpers.add("larger")
        operands = [self._element(operand, value.size == 1) for operand in value.operands]
        return template.format(*operands, prefix=self.prefix)

    def _element(self, value: Value, alone: bool = False) -> str:
        """The number i of a value, or its only one: what stands there needs no more brackets."""
        if value.operation == "constant" and value.size == 1:
            number = float(value.detail.reshape(-1)[0])
            return repr(number) if number >= 0.0 else f"({number!r})"
        if id(value) in self._written:
            return f"({self._written[id(value)]})"
        if value.operation == "reshape":
            return self._element(value.operands[0], alone)
        index = "0" if alone or value.size == 1 else "i"
        if value.operation == "take" and id(value) not in self._arrays:
            found = affine(value.detail)
            assert found is not None
            first, step = found
            base, offset = self._base(value.operands[0])
            moved = "" if index == "0" or step == 0 else "i" if step == 1 else f"{step} * i"
            start = str(offset + first) if offset + first or not moved else ""
            return f"{base}[{' + '.join(filter(None, (start, moved)))}]"
        base, offset = self._base(value)
        place = " + ".join(part for part in (str(offset) if offset else "", index) if part)
        return f"{base}[{offset if index == '0' else place}]"

    def _base(self, value: Value) -> tuple[str, int]:
        """The array in which a value lies, one number beside the next, and where it begins there."""
        if id(value) in self._arrays:
            return self._arrays[id(value)], 0
        if value.operation == "reshape":
            return self._base(value.operands[0])
        if value.operation == "take" and (found := affine(value.detail)) and found[1] == 1:
            base, offset = self._base(value.operands[0])
            return base, offset + found[0]
        return self._declare(value), 0

    def _address(self, value: Value) -> str:
        base, offset = self._base(value)
        return f"{base} + {offset}" if offset else base

    def _indices(self, indices: np.ndarray) -> str:
        name = self._new("t")
        self._lines += _table("int", name, [str(index) for index in indices.reshape(-1).tolist()])
        return name


def _in_place(value: Value) -> bool:
    """Whether a value is read where its operand lies, or is known."""
    if value.operation == "take":
        return affine(value.detail) is not None
    return value.operation in ("input", "constant", "reshape")


def _fusable(values: Sequence[Value]) -> set[int]:
    """Operations number by number that one other uses, number by number too, or a concatenation."""
    uses = Counter(id(operand) for value in values for operand in value.operands)
    return {
        id(operand)
        for value in values
        for operand in value.operands
        if operand.operation in BY_NUMBER
        and uses[id(operand)] == 1
        and (value.operation == "concat" or (value.operation in BY_NUMBER and operand.size == value.size))
    }


def _table(kind: str, name: str, numbers: Sequence[str]) -> list[str]:
    rows = textwrap.wrap(", ".join(numbers), WIDTH, break_long_words=False, break_on_hyphens=False)
    return [f"static const {kind} {name}[{len(numbers)}] = {{", *(f"    {row}" for row in rows), "};"]
