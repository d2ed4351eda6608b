"""Torch modules exported: the field of one, traced at one state, as a `Program`.

Tracing follows torch through autograd, and leaves a list of its elementary operations with the weights as
constants. Whatever only moves numbers (views, slices, concatenations, look-ups) is done once, here, on their
addresses, by torch itself.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import torch
from torch import Tensor, fx, nn
from torch.fx.experimental.proxy_tensor import make_fx

from flexsurr.simulation.rhs import evaluate
from flexsurr.surrogates.program import CODES, ONE_OPERAND, TWO_OPERANDS, Program
from flexsurr.surrogates.torch_module import field as field_of

MOVES = {
    "view", "_unsafe_view", "permute", "transpose", "t", "unsqueeze", "squeeze", "expand", "slice", "select",
    "split", "split_with_sizes", "unbind", "cat", "stack", "index", "index_select", "gather", "flip",
    "repeat", "slice_scatter", "select_scatter", "diagonal", "tril", "triu",
    "broadcast_in_dim",
}  # fmt: skip
SAME = {"alias", "clone", "detach", "lift_fresh_copy"}
LIKE = {"zeros_like": 0.0, "ones_like": 1.0}


_aten = torch.ops.aten
TAKEN_APART: list[Any] = [
    _aten.elu, _aten.elu_backward, _aten.gelu, _aten.gelu_backward, _aten.leaky_relu,
    _aten.leaky_relu_backward, _aten.hardtanh, _aten.hardtanh_backward, _aten._softmax,
    _aten._softmax_backward_data, _aten._log_softmax, _aten._log_softmax_backward_data,
    _aten.native_layer_norm, _aten.native_layer_norm_backward, _aten.linalg_vector_norm, _aten.var_mean,
    _aten.var, _aten.celu, _aten.glu,
]  # fmt: skip
"""What torch counts among its elementary operations and the machine does not."""

TRIED = 32  # states at which a program is held against its module


class NotExportable(Exception):
    """A module does what the machine of `program` cannot do."""


@dataclass(frozen=True)
class Places:
    """A tensor by the addresses of its numbers."""

    addresses: Tensor


@dataclass
class _Writer:
    memory: list[float]
    code: list[list[int]] = field(default_factory=list)
    table: list[int] = field(default_factory=list)

    def block(self, shape: Sequence[int], values: Tensor | None = None) -> Tensor:
        """Addresses of new memory of a shape."""
        count = int(np.prod(shape, dtype=int))
        first = len(self.memory)
        self.memory += [0.0] * count if values is None else values.double().reshape(-1).tolist()
        return torch.arange(first, first + count).reshape(tuple(shape))

    def places(self, value: Any) -> Tensor:
        """The addresses of a value; constants are put into memory."""
        if isinstance(value, Places):
            return value.addresses
        constant = value if isinstance(value, Tensor) else torch.tensor(value, dtype=torch.float64)
        if constant.is_complex():
            raise NotExportable("complex numbers")
        return self.block(constant.shape, constant)

    def write(self, name: str, n: int, out: int, *operands: int) -> None:
        self.code.append([CODES[name], n, out, *operands, *[0] * (6 - len(operands))])

    def looked_up(self, addresses: Tensor) -> int:
        """Where the table holds these addresses."""
        self.table += addresses.reshape(-1).tolist()
        return len(self.table) - addresses.numel()

    def strided(self, addresses: Tensor) -> tuple[int, int]:
        """First address and stride of a tensor's numbers, which are copied if they have none."""
        steps = addresses.reshape(-1).diff().unique()
        if len(steps) > 1:
            return self.copied(addresses), 1
        return _first(addresses), int(steps[0]) if len(steps) else 0

    def contiguous(self, addresses: Tensor) -> int:
        """The first address of a tensor's numbers one beside the other, copied if they are not."""
        first, stride = self.strided(addresses)
        return first if stride == 1 or addresses.numel() == 1 else self.copied(addresses)

    def copied(self, addresses: Tensor) -> int:
        out = _first(self.block(addresses.shape))
        self.write("gather", addresses.numel(), out, self.looked_up(addresses))
        return out

    def each(self, name: str, *operands: Any) -> Places:
        """An operation number by number, broadcast."""
        places = torch.broadcast_tensors(*map(self.places, operands))
        out = self.block(places[0].shape)
        pairs = [number for place in places for number in self.strided(place)]
        self.write(name, out.numel(), _first(out), *pairs)
        return Places(out)

    def reduced(self, name: str, value: Any, axes: Sequence[int] | None, keep: bool) -> Places:
        """The sum or the largest over `axes`, all by default."""
        places = self.places(value)
        axes = [axis % places.ndim for axis in (axes or range(places.ndim))]
        kept = [axis for axis in range(places.ndim) if axis not in axes]
        ordered = places.permute(*kept, *axes)
        shape = [1 if axis in axes else size for axis, size in enumerate(places.shape)]
        final = shape if keep else [places.shape[axis] for axis in kept]
        terms = int(np.prod([places.shape[axis] for axis in axes], dtype=int))
        if terms == 1:
            return Places(ordered.reshape(final))
        out = self.block(final)
        self.write(name, out.numel(), _first(out), self.contiguous(ordered), terms)
        return Places(out)

    def product(self, a: Any, b: Any) -> Places:
        """The matrix product of (n, k) and (k, m)."""
        first, second = self.places(a), self.places(b)
        (rows, inner), columns = first.shape, second.shape[1]
        out = self.block((rows, columns))
        operands = self.contiguous(first), inner, self.contiguous(second), columns
        self.write("matmul", rows, _first(out), *operands)
        return Places(out)

    def added(self, base: Any, into: Tensor, what: Any) -> Places:
        """`base` with `what` added to the numbers whose places in it are `into`."""
        places = self.places(base)
        out = self.copied(places)
        what = torch.broadcast_to(self.places(what), into.shape)
        self.write("scatter_add", into.numel(), self.looked_up(out + into), *self.strided(what))
        return Places(torch.arange(out, out + places.numel()).reshape(places.shape))

    def solved(self, a: Any, b: Any) -> Places:
        """X of A X = B for (1, n, n) and (1, n) or (1, n, k)."""
        matrix, right = self.places(a), self.places(b)
        n = matrix.shape[-1]
        if matrix.numel() != n * n:
            raise NotExportable("more than one linear system at a state")
        out = self.copied(right)
        self.write("solve", n, out, self.copied(matrix), right.numel() // n)
        return Places(torch.arange(out, out + right.numel()).reshape(right.shape))


def _first(addresses: Tensor) -> int:
    """The first of them; 0 where there is none."""
    return int(addresses.reshape(-1)[0]) if addresses.numel() else 0


def program_of(module: nn.Module, states: int) -> Program:
    """The scaled field of `module`, in double precision, as a program.

    Raises NotExportable naming an operation that the machine has not, or where the program is not the
    module: one that decides by the values of its states what to do.
    """
    example = torch.linspace(-0.3, 0.4, states, dtype=torch.float64).reshape(1, -1)
    table = {**torch._decomp.core_aten_decompositions(), **torch._decomp.get_decompositions(TAKEN_APART)}
    try:
        graph = make_fx(lambda x: field_of(module, x), decomposition_table=table)(example)
    except Exception as error:
        raise NotExportable(" ".join(str(error).split())[:200]) from error
    writer = _Writer([0.0] * (1 + states))  # a zero, to which tril points, and the states
    values: dict[fx.Node, Any] = {}
    for node in graph.graph.nodes:
        if node.op == "placeholder":
            values[node] = Places(torch.arange(1, 1 + states).reshape(1, -1))
        elif node.op == "get_attr":
            values[node] = getattr(graph, str(node.target)).detach()
        elif node.op == "call_function":
            arguments, keywords = (
                fx.node.map_arg(given, values.__getitem__) for given in (node.args, node.kwargs)
            )
            try:
                values[node] = _carried_out(writer, node.target, arguments, dict(keywords))
            except (TypeError, ValueError, RuntimeError, AttributeError) as error:
                raise NotExportable(f"{node.target}: {' '.join(str(error).split())[:200]}") from error
        else:
            result = writer.places(values[node.args[0]]).reshape(-1)
    program = Program(
        np.array(writer.code, dtype=np.int64).reshape(-1, 9),
        np.array([*writer.table, 0], dtype=np.int64),
        np.array(writer.memory),
        result.numpy().astype(np.int64),
    )
    _compare(program, module, states)
    return program


def _compare(program: Program, module: nn.Module, states: int) -> None:
    """Raise NotExportable where the program and the module differ at states of the order of one."""
    x = np.random.default_rng(0).normal(size=(TRIED, states))
    expected = field_of(module, torch.from_numpy(x)).detach().numpy()
    found = np.empty_like(expected)
    for state, rates in zip(x, found, strict=True):
        evaluate(program, 0.0, state, rates, np.empty(0))
    within = np.isfinite(expected)
    largest = np.abs(expected[within]).max(initial=0.0)
    if not within.any() or not np.allclose(found[within], expected[within], rtol=1e-9, atol=1e-9 * largest):
        raise NotExportable("it is another function at other states: it decides by their values")


def _carried_out(writer: _Writer, target: Any, arguments: tuple[Any, ...], keywords: dict[str, Any]) -> Any:
    name = str(target).removeprefix("aten.").removeprefix("prims.").split(".")[0]
    if name == "_linalg_check_errors":
        return None
    if not any(isinstance(value, Places) for value in _flat((arguments, keywords))):
        return target(*arguments, **keywords)
    first = arguments[0]
    if name.startswith("<built-in function getitem"):
        return first[arguments[1]]
    if name in SAME or (name == "_to_copy" and keywords.get("dtype", torch.float64) == torch.float64):
        return first
    if name in LIKE or name == "full_like":
        value: Any = LIKE.get(name) if name in LIKE else arguments[1]
        return torch.full(tuple(writer.places(first).shape), float(value), dtype=torch.float64)
    if name in MOVES:
        placed = fx.node.map_aggregate(arguments, lambda value: _moved(writer, value))
        moved = target(*placed, **keywords)
        return Places(moved) if isinstance(moved, Tensor) else [Places(part) for part in moved]
    if name in ONE_OPERAND:
        return writer.each(name, first)
    if name in TWO_OPERANDS:
        second = arguments[1]
        if (alpha := keywords.get("alpha", 1)) != 1:
            second = writer.each("mul", second, alpha)
        if name == "pow" and second == 2:
            return writer.each("mul", first, first)
        return writer.each(name, first, second)
    if name == "where":
        return writer.each(name, *arguments)
    if name == "clamp":
        low, high = (*arguments[1:], None)[:2]
        above = first if low is None else writer.each("maximum", first, low)
        return above if high is None else writer.each("minimum", above, high)
    if name in ("sum", "amax", "mean"):
        axes = arguments[1] if len(arguments) > 1 else keywords.get("dim")
        keep = arguments[2] if len(arguments) > 2 else keywords.get("keepdim", False)
        total = writer.reduced("amax" if name == "amax" else "sum", first, axes, keep)
        share = total.addresses.numel() / writer.places(first).numel()
        return writer.each("mul", total, share) if name == "mean" else total
    if name == "var":
        total = writer.reduced("sum", first, arguments[1], True)
        terms = writer.places(first).numel() // total.addresses.numel()
        apart = writer.each("sub", first, writer.each("mul", total, 1.0 / terms))
        squares = writer.reduced("sum", writer.each("mul", apart, apart), arguments[1], False)
        return writer.each("mul", squares, 1.0 / (terms - arguments[2]))
    if name == "mm":
        return writer.product(*arguments)
    if name == "addmm" and set(keywords.values()) <= {1}:
        return writer.each("add", first, writer.product(*arguments[1:]))
    if name == "bmm":
        pairs = zip(*(writer.places(value).unbind() for value in arguments), strict=True)
        products = [writer.product(Places(a), Places(b)).addresses for a, b in pairs]
        return Places(torch.stack(products))
    if name == "index_put" and arguments[3:] == (True,):
        chosen = tuple(slice(None) if index is None else index for index in arguments[1])
        return writer.added(first, _within(writer, first)[chosen], arguments[2])
    if name == "index_add" and set(keywords.values()) <= {1}:
        into = _within(writer, first).index_select(arguments[1], arguments[2])
        return writer.added(first, into, arguments[3])
    if name == "_linalg_solve_ex":
        return (writer.solved(*arguments[:2]), *[None] * 3)
    raise NotExportable(f"{target} at a state")


def _moved(writer: _Writer, value: Any) -> Any:
    """What torch moves: addresses in place of numbers; indices stay what they are."""
    is_number = isinstance(value, Places) or (isinstance(value, Tensor) and value.is_floating_point())
    return writer.places(value) if is_number else value


def _within(writer: _Writer, value: Any) -> Tensor:
    """The place of each number within its tensor."""
    shape = writer.places(value).shape
    return torch.arange(shape.numel()).reshape(shape)


def _flat(value: Any) -> list[Any]:
    if isinstance(value, list | tuple):
        return [inner for part in value for inner in _flat(part)]
    return [inner for part in value.values() for inner in _flat(part)] if isinstance(value, dict) else [value]
