"""A model as one Python file that needs NumPy alone."""

from collections.abc import Sequence

import numpy as np

from flexsurr.export.c_statements import affine
from flexsurr.export.expressions import EACH, Value, ordered
from flexsurr.export.model import ExportedModel, Quantity

FORMULAS = {
    "add": "{0} + {1}", "sub": "{0} - {1}", "mul": "{0} * {1}", "div": "{0} / {1}", "neg": "-{0}",
    "pow": "{0} ** {1}", "atan2": "np.arctan2({0}, {1})", "asin": "np.arcsin({0})",
    "abs": "np.abs({0})", "exp": "np.exp({0})", "expm1": "np.expm1({0})", "log": "np.log({0})",
    "log1p": "np.log1p({0})", "sqrt": "np.sqrt({0})", "rsqrt": "1.0 / np.sqrt({0})",
    "reciprocal": "1.0 / {0}", "sin": "np.sin({0})", "cos": "np.cos({0})", "tanh": "np.tanh({0})",
    "atan": "np.arctan({0})", "erf": "_erf({0})", "sigmoid": "0.5 + 0.5 * np.tanh(0.5 * {0})",
    "relu": "np.maximum({0}, 0.0)", "maximum": "np.maximum({0}, {1})", "minimum": "np.minimum({0}, {1})",
    "gt": "1.0 * ({0} > {1})", "ge": "1.0 * ({0} >= {1})", "lt": "1.0 * ({0} < {1})",
    "le": "1.0 * ({0} <= {1})", "eq": "1.0 * ({0} == {1})", "ne": "1.0 * ({0} != {1})",
    "where": "np.where({0} != 0.0, {1}, {2})",
}  # fmt: skip

HELPERS = {
    "_erf": """\
_erf = np.vectorize(math.erf, otypes=[float])
""",
    "_joined": '''\
def _joined(*parts):
    """Arrays (..., n) one after the other along the last axis."""
    shape = np.broadcast_shapes(*(part.shape[:-1] for part in parts))
    return np.concatenate([np.broadcast_to(part, (*shape, part.shape[-1])) for part in parts], axis=-1)
''',
    "_matrix": '''\
def _matrix(numbers, rows, columns):
    """Matrices (..., rows, columns) of what lies row by row in (..., rows * columns)."""
    return numbers.reshape(*numbers.shape[:-1], rows, columns)
''',
    "_flat": '''\
def _flat(matrices):
    """The opposite of _matrix."""
    return matrices.reshape(*matrices.shape[:-2], -1)
''',
    "_added": '''\
def _added(base, places, numbers):
    """`base` (..., n) with `numbers` added at their places, of which one may occur more than once."""
    shape = np.broadcast_shapes(base.shape[:-1], numbers.shape[:-1])
    total = np.array(np.broadcast_to(base, (*shape, base.shape[-1])))
    np.add.at(total, (..., places), numbers)
    return total
''',
}

STEP = '''\
def step(x, u=None, h=STEP_S):
    """The states after one step of the classical Runge-Kutta method of order 4 over h seconds, u held."""
    first = rates(x, u)
    second = rates(x + 0.5 * h * first, u)
    third = rates(x + 0.5 * h * second, u)
    fourth = rates(x + h * third, u)
    return x + h / 6.0 * (first + 2.0 * (second + third) + fourth)
'''


def numpy_file(model: ExportedModel) -> str:
    """The text of the file."""
    printer = _Printer()
    if model.rates is None:
        functions = [
            _function(
                printer,
                "outputs",
                "u",
                model.results,
                "The outputs (..., k) at the inputs u (..., n).",
                ["u"],
            )
        ]
    else:
        forces = f"np.array({[quantity.start for quantity in model.inputs]})"
        functions = [
            _function(
                printer,
                "rates",
                "x, u=None",
                model.rates,
                "The rates (..., d) of the states x (..., d) under inputs u (..., n), by default at rest.",
                ["x", "u"],
                forces,
            ),
            _function(
                printer,
                "outputs",
                "x, u=None",
                model.results,
                "The outputs (..., k) of the states x (..., d) under inputs u (..., n), by default at rest.",
                ["x", "u"],
                forces,
            ),
            STEP,
        ]
    code = "\n\n".join(functions)
    helpers = [text for name, text in HELPERS.items() if f"{name}(" in code]
    imports = [*(["import math", ""] if "_erf(" in code else []), "import numpy as np"]
    constants = [
        *_names("STATES", model.states),
        *_names("INPUTS", model.inputs),
        *_names("OUTPUTS", model.outputs),
    ]
    if model.rates is not None:
        constants += [
            f"START = np.array({[quantity.start for quantity in model.states]})",
            f"STEP_S = {model.step_s!r}",
        ]
    about = "\n".join(model.about).replace("\\", "\\\\").replace('"', "'")
    return "\n".join(
        [
            f'"""{model.name}: a model in NumPy alone.\n\n{about}\n"""',
            "",
            *imports,
            "",
            *constants,
            "",
            *printer.constants,
            "",
            "",
            "\n\n".join([*helpers, *functions]),
        ]
    )


def _names(title: str, quantities: Sequence[Quantity]) -> list[str]:
    """Names with units, in the order of the arrays."""
    rows = [f"    {quantity.name!r}: {quantity.unit!r},  # {quantity.meaning}" for quantity in quantities]
    return [f"{title} = {{", *rows, "}"]


def _function(
    printer: "_Printer",
    name: str,
    arguments: str,
    value: Value,
    text: str,
    arrays: Sequence[str],
    default: str = "",
) -> str:
    body = printer.of(value)
    given = [f"{array} = np.asarray({array}, dtype=float)" for array in arrays]
    if default:
        given[-1] = f"u = {default} if u is None else np.asarray(u, dtype=float)"
    lines = [f'"""{text}"""', *given, *body]
    return "\n".join([f"def {name}({arguments}):", *(f"    {line}" for line in lines), ""])


class _Printer:
    """Every value is an array (..., n) of its numbers; `constants` collects those that are known."""

    def __init__(self) -> None:
        self.constants: list[str] = []
        self._lines: list[str] = []
        self._names: dict[int, str] = {}

    def of(self, result: Value) -> list[str]:
        self._lines, self._names = [], {}
        for each in ordered([result]):
            if each.operation == "input":
                self._names[id(each)] = each.detail
            elif each.operation == "reshape":
                self._names[id(each)] = self._names[id(each.operands[0])]
            elif each.operation == "constant" and each.size == 1:
                self._names[id(each)] = _number(each.detail.reshape(-1)[0])
            elif each.operation == "constant":
                self._names[id(each)] = f"_C{len(self.constants)}"
                numbers = each.detail.reshape(-1).tolist()
                self.constants.append(f"{self._names[id(each)]} = np.array({numbers})")
            else:
                self._names[id(each)] = f"v{len(self._lines)}"
                self._lines.append(f"{self._names[id(each)]} = {self._expression(each)}")
        if result.operation == "input" and not result.size:
            return ["return np.empty((*x.shape[:-1], 0))"]
        return [*self._lines, f"return {self._names[id(result)]}"]

    def _expression(self, value: Value) -> str:
        names = [self._names[id(operand)] for operand in value.operands]
        if value.operation in (*EACH, "where"):
            return FORMULAS[value.operation].format(*names)
        if value.operation == "take":
            return f"{names[0]}[..., {_key(value.detail.reshape(-1))}]"
        if value.operation == "concat":
            parts = [self._array(operand) for operand in value.operands]
            return f"_joined({', '.join(parts)})"
        if value.operation == "matmul":
            return self._product(value)
        if value.operation in ("sum", "amax"):
            whole = value.operands[0]
            rows = f"_matrix({names[0]}, {whole.size // value.detail}, {value.detail})"
            return f"{rows}.{'sum' if value.operation == 'sum' else 'max'}(axis=-1)"
        if value.operation == "scatter_add":
            base, added = map(self._array, value.operands)
            return f"_added({base}, {value.detail.tolist()}, {added})"
        assert value.operation == "solve"
        n = value.operands[0].shape[0]
        matrix, right = map(self._array, value.operands)
        columns = f"_matrix({right}, {n}, {value.detail})"
        return f"_flat(np.linalg.solve(_matrix({matrix}, {n}, {n}), {columns}))"

    def _array(self, value: Value) -> str:
        """A value as an array, where a number would not do."""
        name = self._names[id(value)]
        return f"np.array([{name}])" if value.operation == "constant" and value.size == 1 else name

    def _product(self, value: Value) -> str:
        rows, inner, columns = value.detail
        first, second = map(self._array, value.operands)
        if rows == 1 and value.operands[1].operation == "constant":
            return f"{first} @ _matrix({second}, {inner}, {columns})"
        return f"_flat(_matrix({first}, {rows}, {inner}) @ _matrix({second}, {inner}, {columns}))"


def _number(number: float) -> str:
    return repr(float(number)) if number >= 0.0 else f"({float(number)!r})"


def _key(indices: np.ndarray) -> str:
    """A slice where that will do, which is quicker than a list."""
    found = affine(indices)
    if found is None or found[1] <= 0:
        return str(indices.tolist())
    first, step = found
    last = first + step * (len(indices) - 1) + 1
    return f"{first}:{last}" + (f":{step}" if step > 1 else "")
