"""The one generic right-hand side ẋ = f(t, x) that every integrator calls.

A *model* is a right-hand side with named states. A *kernel* is its compiled form: a NamedTuple of
scalars and contiguous float64 arrays whose class says which equations they belong to. Integrators
call `rhs(kernel, t, x, dx, work)` and are compiled once per class of kernel; floors above add their
equations with `implements_rhs`, so that no integrator names a model. Resolving the equations by the
class of an argument (and not by a function passed in) is what lets numba keep the machine code on
disk between processes.
"""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any, NamedTuple, Protocol, runtime_checkable

import numpy as np
from numba import njit, types
from numba.extending import overload
from numpy.typing import NDArray

from flexsurr.kernel_cache import keeps, not_compiled
from flexsurr.simulation.machine_code import compile_once
from flexsurr.simulation.on_demand import translate_on_demand

compile_once()
translate_on_demand()

Array = NDArray[np.float64]

# Reassociation and contraction vectorise sums; the flags that assume finite numbers stay off, so
# that a trajectory which leaves them is noticed.
FLOATING_POINT = {"contract", "reassoc", "arcp", "nsz", "afn"}


@runtime_checkable
class Model(Protocol):
    """A right-hand side in Python, with the names and units of its states."""

    @property
    def state_names(self) -> tuple[str, ...]:
        """One name for each state; their number is d."""
        ...

    @property
    def state_units(self) -> tuple[str, ...]:
        """One unit for each state."""
        ...

    @property
    def breakpoints(self) -> tuple[float, ...]:
        """Times [s] at which f jumps; an integrator starts anew at each."""
        ...

    def derivative(self, t: float, x: Array) -> Array:
        """ẋ at time `t` [s] and state `x` (d,), in the units of the states per second."""
        ...


@runtime_checkable
class CompiledModel(Model, Protocol):
    """A model that compiled integrators can step: a kernel and the size of its workspace."""

    @property
    def kernel(self) -> NamedTuple:
        """The equations' constants; its class says which equations they belong to."""
        ...

    @property
    def work_size(self) -> int:
        """Number of float64 values `rhs` may use as scratch."""
        ...


class ByKernel:
    """What every CompiledModel does in the same way."""

    def derivative(self: CompiledModel, t: float, x: Array) -> Array:
        """ẋ (d,) at time `t` [s] and state `x` (d,), through the kernel."""
        x = np.ascontiguousarray(x, dtype=np.float64)
        dx = np.empty_like(x)
        evaluate(self.kernel, float(t), x, dx, np.empty(self.work_size))
        return dx


@dataclass(frozen=True, eq=False)
class Forced:
    """A model and what acts on it besides, which a subclass adds to its rates."""

    model: Any  # a Model; what more it has, as an energy, is passed on

    @property
    def state_names(self) -> tuple[str, ...]:
        """Those of the model."""
        names: tuple[str, ...] = self.model.state_names
        return names

    @property
    def state_units(self) -> tuple[str, ...]:
        """Those of the model."""
        units: tuple[str, ...] = self.model.state_units
        return units

    @property
    def jumps(self) -> Iterable[float]:
        """Times [s] at which what acts may jump."""
        return ()

    @property
    def breakpoints(self) -> tuple[float, ...]:
        """Times [s] at which the rates may jump: those, and the model's own."""
        return tuple(sorted({*self.model.breakpoints, *self.jumps}))

    @property
    def energy(self) -> Any:
        """The model's own energy, without the work of what acts; AttributeError where it has none."""
        return self.model.energy


def rhs(kernel: Any, t: float, x: Array, dx: Array, work: Array) -> None:
    """Write ẋ = f(t, x) into `dx` (d,). `work` is scratch of at least the model's `work_size`.

    Callable from compiled code only; from Python call a model's `derivative` or `evaluate`.
    """
    raise not_compiled("right-hand side", "rhs", kernel)


def implements_rhs(
    kernel_class: type, inline: bool = True
) -> Callable[[Callable[..., None]], Callable[..., None]]:
    """Register the decorated function (kernel, t, x, dx, work) -> None as `rhs` of `kernel_class`.

    Its arguments must carry these names. Write loops over states, not slices: assigning a slice costs
    seconds of compilation. Equations must not allocate: they are compiled without numba's reference
    counts, whose atomic operations cost as much as a small kernel. `inline` puts them into every stage of
    an integrator; long equations are better called, for a dozen copies take long to compile.
    """
    return registered(rhs, kernel_class, forceinline=inline)


def registered(
    generic: Callable[..., None], kernel_class: type, **options: Any
) -> Callable[[Callable[..., None]], Callable[..., None]]:
    """Register the decorated function (kernel, t, x, dx, work) -> None as `generic` of `kernel_class`."""
    options = {"fastmath": FLOATING_POINT, "error_model": "numpy", "_nrt": False, **options}
    # kept by themselves, they are compiled once for all integrators, and for every load
    options["cache"] = keeps(kernel_class)

    def register(equations: Callable[..., None]) -> Callable[..., None]:
        @overload(generic, jit_options=options)
        def resolve(kernel, t, x, dx, work):
            if isinstance(kernel, types.BaseNamedTuple) and kernel.instance_class is kernel_class:
                return equations
            return None

        return equations

    return register


def rates(model: Model, t: Array, x: Array) -> Array:
    """ẋ (m, d) at times `t` (m,) [s] and states `x` (m, d), by compiled code if the model has it."""
    if not isinstance(model, CompiledModel):
        return np.array([model.derivative(*sample) for sample in zip(t, x, strict=True)])
    dx = np.empty_like(x)
    evaluate_each(model.kernel, t, np.ascontiguousarray(x), dx, np.empty(model.work_size))
    return dx


@njit(cache=True, error_model="numpy")
def evaluate_each(kernel, t, x, dx, work):
    """`evaluate` for m samples: t (m,), x and dx (m, d)."""
    for k in range(t.size):
        rhs(kernel, t[k], x[k], dx[k], work)


@njit(cache=True, error_model="numpy")
def evaluate(kernel, t, x, dx, work):
    """`rhs` as a call from Python: write ẋ into `dx`."""
    rhs(kernel, t, x, dx, work)
