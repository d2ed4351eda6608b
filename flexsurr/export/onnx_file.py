"""A model in ONNX, double precision, for any number of states at a time.

Inputs are `states` (batch, d) and `inputs` (batch, n), outputs `rates` (batch, d) and `outputs` (batch, k);
what a model has none of is left out. Names, units and values at rest stand in the metadata, as JSON.
"""

import json
from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

import numpy as np

from flexsurr.export.expressions import Value, constant, each, ordered, where
from flexsurr.export.formulas import NotExported
from flexsurr.export.model import ExportedModel

OPSET = 18
IR_VERSION = 9
"""Of onnx 1.14, which any runtime since the spring of 2023 reads."""

OPERATORS = {
    "add": "Add", "sub": "Sub", "mul": "Mul", "div": "Div", "neg": "Neg", "pow": "Pow", "abs": "Abs",
    "exp": "Exp", "log": "Log", "sqrt": "Sqrt", "reciprocal": "Reciprocal", "sin": "Sin", "tanh": "Tanh",
    "sigmoid": "Sigmoid", "relu": "Relu", "maximum": "Max", "minimum": "Min",
}  # fmt: skip
COMPARISONS = {
    "gt": ("Greater", False), "ge": ("GreaterOrEqual", False), "lt": ("Less", False),
    "le": ("LessOrEqual", False), "eq": ("Equal", False), "ne": ("Equal", True),
}  # fmt: skip
"""The operator of each comparison, and whether its answer is turned round."""

REDUCTIONS = {"sum": "ReduceSum", "amax": "ReduceMax"}
STATES_NAME, INPUTS_NAME, RATES_NAME, OUTPUTS_NAME = "states", "inputs", "rates", "outputs"

_ERF_IS_ONE = 6.0
_ERF_TERMS = 120
_ATAN_HALVINGS = 4
_ATAN_TERMS = 10


def onnx_file(model: ExportedModel) -> bytes:
    """The file's content. Raises NotExported where the package onnx is missing."""
    try:
        import onnx
    except ImportError:
        raise NotExported("--to onnx needs the package onnx: pip install 'flexsurr[export]'") from None
    helper, double = onnx.helper, onnx.TensorProto.DOUBLE

    def signature(name: str, size: int) -> Any:
        return helper.make_tensor_value_info(name, double, ["batch", size])

    given = [(STATES_NAME, model.x), (INPUTS_NAME, model.u)]
    given = [(name, argument) for name, argument in given if argument.size]
    graph = _Graph(onnx, given[0][0])
    for name, argument in given:
        graph.names[argument.detail] = name
    possible = [(RATES_NAME, model.rates), (OUTPUTS_NAME, model.results)]
    results = [(name, value) for name, value in possible if value is not None and value.size]
    for name, value in results:
        graph.node("Identity", [graph.full(value)], output=name)
    proto = helper.make_model(
        helper.make_graph(
            graph.nodes,
            model.name,
            [signature(name, argument.size) for name, argument in given],
            [signature(name, value.size) for name, value in results],
            graph.initializers,
        ),
        opset_imports=[helper.make_opsetid("", OPSET)],
        ir_version=IR_VERSION,
        producer_name="flexsurr",
        doc_string="\n".join(model.about),
    )
    about = {
        name: json.dumps([asdict(quantity) for quantity in getattr(model, name)], ensure_ascii=False)
        for name in ("states", "inputs", "outputs")
    }
    helper.set_model_props(proto, about | ({"step_s": repr(model.step_s)} if model.rates is not None else {}))
    onnx.checker.check_model(proto)
    content: bytes = proto.SerializeToString()
    return content


class _Graph:
    """Nodes; every value is a tensor (batch, n) of its numbers, constants are (n,)."""

    def __init__(self, onnx: Any, given: str) -> None:
        self.onnx = onnx
        self.given = given  # an input, which says how many there are in the batch
        self.nodes: list[Any] = []
        self.initializers: list[Any] = []
        self.names: dict[Any, str] = {}
        self._numbers: dict[tuple[Any, ...], str] = {}
        self._batch = ""

    def node(self, operator: str, operands: Sequence[str], output: str = "", **attributes: Any) -> str:
        """The name of an operator's output."""
        output = output or f"v{len(self.nodes)}"
        self.nodes.append(self.onnx.helper.make_node(operator, list(operands), [output], **attributes))
        return output

    def known(self, array: np.ndarray) -> str:
        """The name of numbers that are known, doubles or 64-bit integers."""
        key = (array.dtype.str, array.shape, array.tobytes())
        if key not in self._numbers:
            self._numbers[key] = f"c{len(self.initializers)}"
            self.initializers.append(self.onnx.numpy_helper.from_array(array, self._numbers[key]))
        return self._numbers[key]

    def whole(self, *numbers: int) -> str:
        """Integers, (n,)."""
        return self.known(np.array(numbers, dtype=np.int64))

    def of(self, result: Value) -> str:
        """The name of the tensor that holds `result`."""
        for needed in ordered([result]):
            if needed not in self.names and (needed is result or needed.operation != "constant"):
                self.names[needed] = self._tensor(needed)
        return self.names[result]

    def full(self, value: Value) -> str:
        """As `of`, for each of the batch, a constant too."""
        name = self.of(value)
        if value.operation != "constant":
            return name
        return self.node("Expand", [name, self._shape(value.size)])

    def _shape(self, size: int) -> str:
        """(batch, size)."""
        if not self._batch:
            self._batch = self.node("Shape", [self.given], start=0, end=1)
        return self.node("Concat", [self._batch, self.whole(size)], axis=0)

    def _matrices(self, value: Value, rows: int, columns: int) -> str:
        """A value as (batch, rows, columns); a constant as (rows, columns)."""
        batch = () if value.operation == "constant" else (0,)
        return self.node("Reshape", [self.of(value), self.whole(*batch, rows, columns)])

    def _flat(self, name: str, size: int) -> str:
        return self.node("Reshape", [name, self.whole(0, size)])

    def _tensor(self, value: Value) -> str:
        operation, operands = value.operation, value.operands
        if operation == "input":
            return self.names[value.detail]
        if operation == "constant":
            return self.known(value.detail.reshape(-1))
        if operation == "reshape":
            return self.of(operands[0])
        if operation == "take":
            return self.node("Gather", [self.of(operands[0]), self.whole(*value.detail.reshape(-1))], axis=1)
        if operation == "concat":
            return self.node("Concat", [self.full(operand) for operand in operands], axis=1)
        if operation == "matmul":
            return self._product(value)
        if operation in REDUCTIONS:
            matrices = self._matrices(operands[0], operands[0].size // value.detail, value.detail)
            return self.node(REDUCTIONS[operation], [matrices, self.whole(2)], keepdims=0)
        if operation == "scatter_add":
            base, added = map(self.full, operands)
            places = self.node("Expand", [self.whole(*value.detail), self._shape(value.detail.size)])
            return self.node("ScatterElements", [base, places, added], axis=1, reduction="add")
        if operation == "solve":
            return self._solved(value)
        if operation == "where":
            condition, *others = map(self.of, operands)
            zero = self.known(np.zeros(1))
            return self.node("Where", [self.node("Not", [self.node("Equal", [condition, zero])]), *others])
        if operation in COMPARISONS:
            operator, opposite = COMPARISONS[operation]
            answer = self.node(operator, list(map(self.of, operands)))
            answer = self.node("Not", [answer]) if opposite else answer
            return self.node("Cast", [answer], to=self.onnx.TensorProto.DOUBLE)
        if operation in OPERATORS:
            return self.node(OPERATORS[operation], list(map(self.of, operands)))
        return self.of(_made_of_others(operation, *operands))

    def _product(self, value: Value) -> str:
        rows, inner, columns = value.detail
        first, second = value.operands
        if rows == 1 and second.operation == "constant":
            matrix = self.known(second.detail.reshape(inner, columns))
            return self.node("MatMul", [self.of(first), matrix])
        product = self.node(
            "MatMul", [self._matrices(first, rows, inner), self._matrices(second, inner, columns)]
        )
        return self._flat(product, rows * columns)

    def _solved(self, value: Value) -> str:
        """Elimination with pivots, unrolled; the pivot's row is exchanged by a look-up."""
        n, columns = value.operands[0].shape[0], value.detail
        matrix = self._rows(self.full(value.operands[0]), n, n)
        right = self._rows(self.full(value.operands[1]), n, columns)
        rows = self.node("Concat", [matrix, right], axis=2)
        numbers = self.known(np.arange(n, dtype=np.int64)[None, :])
        for k in range(n):
            column = self._flat(self.node("Gather", [rows, self.whole(k)], axis=2), n)
            below = self.node("Mul", [self.node("Abs", [column]), self.known((np.arange(n) >= k) * 1.0)])
            # a row that is not below must not be chosen, not even where all are 0
            below = self.node("Sub", [below, self.known((np.arange(n) < k) * 1.0)])
            pivot = self.node("ArgMax", [below], axis=1, keepdims=1)
            here = self.node("Equal", [numbers, pivot])
            order = self.node("Where", [here, self.whole(k), numbers])
            order = self.node("Where", [self.known(np.arange(n)[None, :] == k), pivot, order])
            rows = self.node("GatherND", [rows, self._rows(order, n, 1)], batch_dims=1)
            pivots = self.node("Gather", [rows, self.whole(k)], axis=1)
            pivots = self.node("Div", [pivots, self.node("Gather", [pivots, self.whole(k)], axis=2)])
            factors = self.node("Gather", [rows, self.whole(k)], axis=2)
            others = self.known((np.arange(n) != k)[None, :, None] * 1.0)
            reduced = self.node("Sub", [rows, self.node("MatMul", [factors, pivots])])
            rows = self.node(
                "Add",
                [
                    self.node("Mul", [reduced, others]),
                    self.node("Mul", [pivots, self.known(1.0 - (np.arange(n) != k)[None, :, None])]),
                ],
            )
        solution = self.node("Slice", [rows, self.whole(n), self.whole(n + columns), self.whole(2)])
        return self._flat(solution, n * columns)

    def _rows(self, name: str, rows: int, columns: int) -> str:
        return self.node("Reshape", [name, self.whole(0, rows, columns)])


def _made_of_others(operation: str, *operands: Value) -> Value:
    """What ONNX has not, or runtimes not in double precision."""
    z = operands[0]
    if operation == "rsqrt":
        return 1.0 / each("sqrt", z)
    if operation == "cos":
        return each("sin", z + 0.5 * np.pi)
    if operation == "expm1":
        # eᶻ − 1 = tanh(z/2) (eᶻ + 1), which loses no digits at 0
        return each("tanh", 0.5 * z) * (each("exp", z) + 1.0)
    if operation == "log1p":
        return each("log", 1.0 + z)
    if operation == "erf":
        return _erf(z)
    if operation == "atan":
        return _atan(z)
    if operation == "atan2":
        return _atan2(z, operands[1])
    if operation == "asin":
        return _atan2(z, each("sqrt", (1.0 - z) * (1.0 + z)))
    raise NotExported(f"ONNX has no operator for {operation}")


def _erf(z: Value) -> Value:
    """The error function by a series without a difference (DLMF 7.6.2), held where it is 1 to rounding."""
    held = each("minimum", each("maximum", z, -_ERF_IS_ONE), _ERF_IS_ONE)
    square = held * held
    series: Value = constant(1.0)
    for n in range(_ERF_TERMS, 0, -1):
        series = 1.0 + square * (2.0 / (2 * n + 1)) * series
    return held * each("exp", -square) * series * float(2.0 / np.sqrt(np.pi))


def _atan(z: Value) -> Value:
    """The arctangent by halving the angle, then its series."""
    for _ in range(_ATAN_HALVINGS):
        z = z / (1.0 + each("sqrt", 1.0 + z * z))
    square = z * z
    series: Value = constant(1.0 / (2 * _ATAN_TERMS + 1))
    for k in range(_ATAN_TERMS - 1, -1, -1):
        series = 1.0 / (2 * k + 1) - square * series
    return 2.0**_ATAN_HALVINGS * z * series


def _atan2(y: Value, x: Value) -> Value:
    """The angle of (x, y): twice that of (√(x² + y²) + |x|, y), and π less that to the left of the axis."""
    length = each("sqrt", x * x + y * y)
    angle = 2.0 * _atan(y / (length + abs(x)))
    turned = where(each("ge", y, 0.0), np.pi - angle, -np.pi - angle)
    return where(each("ge", x, 0.0), angle, turned)
