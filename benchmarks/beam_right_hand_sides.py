"""What one right-hand side of the beam costs: described, numpy and compiled, with and without a load.

Run alone on the machine:  python benchmarks/beam_right_hand_sides.py
The compiled ones are timed within compiled code, as integrators call them.
"""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import yaml
from numba import njit
from timing import compare

from flexsurr.beam import full_order, loaded, reduce, reduced_order
from flexsurr.config.history import Sine
from flexsurr.config.load import TipForce
from flexsurr.config.structure import Structure
from flexsurr.config.study import Reduction
from flexsurr.simulation import rhs

CANTILEVER = Path(__file__).parents[1] / "config/structures/cantilever.yaml"
COMPILED_CALLS = 2000
LOAD = TipForce(force_N=10.0, history=Sine(frequency_rad_s=50.0))
COMPILED, NUMPY, DESCRIBED = KINDS = ("compiled", "numpy", "described")


@njit(error_model="numpy")
def call_repeatedly(kernel, t, x, dx, work, count):
    # Each state depends on the one before, as in an integrator: no two calls overlap.
    for _ in range(count):
        rhs(kernel, t, x, dx, work)
        x[0] += 1e-15 * dx[0]


def caller(model, kind: str, calls: int = COMPILED_CALLS) -> Callable[[], object]:
    half = len(model.state_names) // 2
    x = np.concatenate([np.full(half, 0.3 / half), np.full(half, 0.5 / half)])
    if kind != COMPILED:
        return lambda: model.derivative(1.0, x)
    dx, work = np.empty_like(x), np.empty(model.work_size)
    return lambda: call_repeatedly(model.kernel, 1.0, x, dx, work, calls)


def show(name: str, make: Callable[[str], object], repeats: int) -> None:
    callers = {kind: caller(make(kind), kind) for kind in KINDS}
    timings = compare(f"right-hand side, {name}", callers, repeats, counts={COMPILED: COMPILED_CALLS})
    columns = [f"{1e6 * t.median_s:>11.4g} ± {1e6 * t.spread_s:<7.1g}" for t in timings.values()]
    ratios = [f"{timings[slow].ratio:>10,.0f}" for slow in (DESCRIBED, NUMPY)]
    print(f"{name:<44}", *columns, *ratios, flush=True)


def main() -> None:
    cantilever = Structure(**yaml.safe_load(CANTILEVER.read_text()))
    stick = cantilever.model_dump() | {
        "elements": 16,
        "joints": ("in_plane", "out_of_plane", "torsion"),
        "centre_of_gravity_offset_m": 0.03,
    }
    cases = [
        ("cantilever", cantilever, 1, 20),
        ("cantilever", cantilever.model_copy(update={"elements": 100}), 1, 3),
        ("three joints", Structure(**stick), 3, 5),
    ]
    print(f"{'µs a call':<44}", *(f"{kind:>21}" for kind in KINDS), "described/", "numpy/ compiled")
    for name, structure, modes, repeats in cases:
        basis = reduce(structure, Reduction(modes=modes, normalisation="mass"))
        label = f"{name}, N = {structure.elements}, r = {modes}"
        for variant, term in (("as_printed", "term dropped"), ("hamiltonian", "term kept")):
            show(f"{label}, {term}", lambda k, b=basis, v=variant: reduced_order(b, v, k), repeats)
        show(
            f"{label}, term kept, tip load",
            lambda k, b=basis: loaded(reduced_order(b, "hamiltonian", k), b, LOAD, k),
            repeats,
        )
        show(
            f"{name}, N = {structure.elements}, full order",
            lambda k, s=structure: full_order(s, "hamiltonian", k),
            repeats,
        )


if __name__ == "__main__":
    main()
