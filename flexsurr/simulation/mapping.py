"""A compiled function of vectors y = g(u), the twin of `rhs` for what has no states of its own.

Equations of motion call `mapping(kernel, u, y, work)` for, say, aerodynamic coefficients; the class of
`kernel` chooses the function when they are compiled, so that one function replaces another without a
line changed, and the machine code is kept on disk (see `rhs`).
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numba import njit, types
from numba.extending import overload

from flexsurr.kernel_cache import keeps, not_compiled
from flexsurr.simulation.rhs import FLOATING_POINT, Array


def mapping(kernel: Any, u: Array, y: Array, work: Array) -> None:
    """Write y = g(u) into `y`. `work` is scratch of at least the mapping's `work_size`.

    Callable from compiled code only; from Python call a `CompiledMapping` or `evaluate_mapping`.
    """
    raise not_compiled("mapping", "mapping", kernel)


def implements_mapping(
    kernel_class: type, inline: bool = False, allocates: bool = False
) -> Callable[[Callable[..., None]], Callable[..., None]]:
    """Register the decorated function (kernel, u, y, work) -> None as `mapping` of `kernel_class`.

    Its arguments must carry these names. As with `implements_rhs`, loops and not slices; a function that
    `allocates` (for LAPACK, say) pays for numba's reference counts.
    """
    options: dict[str, Any] = {"fastmath": FLOATING_POINT, "error_model": "numpy", "forceinline": inline}
    # said either way: what is not said is taken over from the caller, equations that don't allocate
    options["_nrt"] = allocates
    options["cache"] = keeps(kernel_class)

    def register(equations: Callable[..., None]) -> Callable[..., None]:
        @overload(mapping, jit_options=options)
        def resolve(kernel, u, y, work):
            if isinstance(kernel, types.BaseNamedTuple) and kernel.instance_class is kernel_class:
                return equations
            return None

        return equations

    return register


_derivatives: dict[type, Callable[..., None]] = {}


def mapping_jacobian(kernel: Any, u: Array, jac: Array, work: Array) -> None:
    """Write ∂y_i/∂u_j into jac (outputs · inputs,), row by row. `work` is as of `mapping`.

    Callable from compiled code only, for mappings that have registered it.
    """
    raise not_compiled("Jacobian of a mapping", "mapping_jacobian", kernel)


def implements_mapping_jacobian(kernel_class: type) -> Callable[[Callable[..., None]], Callable[..., None]]:
    """Register the decorated (kernel, u, jac, work) -> None as `mapping_jacobian` of `kernel_class`."""

    def register(derivatives: Callable[..., None]) -> Callable[..., None]:
        _derivatives[kernel_class] = derivatives
        return derivatives

    return register


@overload(mapping_jacobian, jit_options={"fastmath": FLOATING_POINT, "error_model": "numpy", "_nrt": False})
def _resolve_jacobian(kernel, u, jac, work):
    return _derivatives.get(kernel.instance_class) if isinstance(kernel, types.BaseNamedTuple) else None


@njit(cache=True, error_model="numpy")
def evaluate_mapping(kernel, u, y, work):
    """`mapping` as a call from Python, row by row: `u` (m, inputs), `y` (m, outputs) is written."""
    for row in range(len(u)):
        mapping(kernel, u[row], y[row], work)


@dataclass(frozen=True, eq=False)
class CompiledMapping:
    """A kernel of `mapping`, the size of its scratch, and the names of its inputs and outputs."""

    kernel: NamedTuple
    work_size: int
    input_names: tuple[str, ...]
    output_names: tuple[str, ...]

    def __call__(self, u: Array) -> Array:
        """The outputs (..., outputs) at the inputs `u` (..., inputs)."""
        u = np.ascontiguousarray(u, dtype=np.float64)
        rows = u.reshape(-1, len(self.input_names))
        y = np.empty((len(rows), len(self.output_names)))
        evaluate_mapping(self.kernel, rows, y, np.empty(max(self.work_size, 1)))
        return y.reshape(*u.shape[:-1], len(self.output_names))
