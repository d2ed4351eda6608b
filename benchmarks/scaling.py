"""How costs grow: of models with elements and modes, of training with samples and weights, of data.

    python benchmarks/scaling.py

Each table ends with the exponent of a power law that is fitted to its last three rows, least squares of the
logarithms: what a further doubling will cost.
"""

import tempfile

import numpy as np
import yaml
from beam_right_hand_sides import COMPILED, COMPILED_CALLS, DESCRIBED, NUMPY, caller
from cantilever import STRUCTURE, cantilever_dataset, cantilever_model
from timing import compare, measure
from wing import STRUCTURE as WING

from flexsurr.beam import full_order, reduce, reduced_order
from flexsurr.config.structure import Structure
from flexsurr.config.study import Integrator, Reduction
from flexsurr.config.trial import trial_of
from flexsurr.simulation import simulate
from flexsurr.training import fit

ELEMENTS = (10, 20, 40, 80, 160, 320)
MODES = (1, 2, 4, 6, 8, 10)
WIDTHS = (8, 16, 32, 64)
SHARES = (0.125, 0.25, 0.5, 1.0)
RESPONSES = (100, 1000, 10_000)
REPEATS = 5
DESCRIBED_TO = 80
"""Elements up to which the described model is timed: 320 of them take half a second a call."""


def exponents(sizes: list[float], costs: dict[str, list[float]]) -> dict[str, float]:
    """Of each column, from its last three rows."""
    found = {}
    for name, values in costs.items():
        known = [(size, value) for size, value in zip(sizes, values, strict=True) if np.isfinite(value)][-3:]
        found[name] = float(np.polyfit(*np.log(np.array(known)).T, 1)[0])
    return found


def show(what: str, size: str, rows: dict[float, dict[str, float]], unit: str) -> None:
    """A table of costs against sizes, and the exponents under it."""
    names = list(next(iter(rows.values())))
    print(f"\n{what} [{unit}]\n{size:>12}" + "".join(f"{name:>24}" for name in names))
    for number, costs in rows.items():
        print(f"{number:>12g}" + "".join(f"{costs.get(name, np.nan):>24.4g}" for name in names))
    columns = {name: [costs.get(name, np.nan) for costs in rows.values()] for name in names}
    powers = exponents(list(rows), columns)
    print(f"{'exponent':>12}" + "".join(f"{powers[name]:>24.2f}" for name in names), flush=True)


def against_elements() -> None:
    cantilever = Structure(**yaml.safe_load(STRUCTURE.read_text()))
    rows = {}
    for elements in ELEMENTS:
        structure = cantilever.model_copy(update={"elements": elements})
        basis = reduce(structure, Reduction(modes=1))
        kinds = (COMPILED, NUMPY, DESCRIBED) if elements <= DESCRIBED_TO else (COMPILED, NUMPY)
        callers = {
            f"reduced, {kind}": caller(reduced_order(basis, "hamiltonian", kind), kind) for kind in kinds
        }
        callers["full order, compiled"] = caller(full_order(structure, "hamiltonian", COMPILED), COMPILED)
        compiled = dict.fromkeys((f"reduced, {COMPILED}", "full order, compiled"), COMPILED_CALLS)
        timings = compare(f"right-hand side, N = {elements}", callers, REPEATS, counts=compiled)
        rows[elements] = {name: 1e6 * timing.median_s for name, timing in timings.items()}
    rows = {n: {name: rows[n].get(name, np.nan) for name in rows[ELEMENTS[0]]} for n in rows}
    show("right-hand side of the cantilever, one mode", "elements", rows, "µs")


def against_modes() -> None:
    rows = {}
    for modes in MODES:
        basis = reduce(WING, Reduction(modes=modes, normalisation="mass"))
        callers = {
            f"reduced, {kind}": caller(reduced_order(basis, "hamiltonian", kind), kind)
            for kind in (COMPILED, NUMPY)
        }
        counts = {f"reduced, {COMPILED}": COMPILED_CALLS}
        timings = compare(f"right-hand side, r = {modes}", callers, REPEATS, counts=counts)
        rows[modes] = {name: 1e6 * timing.median_s for name, timing in timings.items()}
    show("right-hand side of the wing, 16 elements", "modes", rows, "µs")


def training(size: str, sizes: dict[float, tuple[int, float]]) -> None:
    """One epoch of Levenberg-Marquardt with so wide a network on such a share of the samples."""
    dataset = cantilever_dataset("hamiltonian")
    generator = np.random.default_rng(0)
    rows = {}
    for number, (width, share) in sizes.items():
        chosen = generator.permutation(len(dataset.x_train))[: round(share * len(dataset.x_train))]
        part = type(dataset)(
            **{
                **vars(dataset),
                "x_train": dataset.x_train[chosen],
                "dx_train": dataset.dx_train[chosen],
            }
        )
        trial = trial_of(architecture="hnn", hidden=(width,), activation="half_log", epochs=60)
        with tempfile.TemporaryDirectory() as folder:
            result = fit(trial, part, folder)
        samples = len(chosen)
        rows[number if size == "weights" else samples] = {"one epoch": 1e3 * result.wall_s / result.epochs}
    show("training of an HNN", size, rows, "ms")


def data() -> None:
    """Free responses of 1 s, of 101 samples each, simulated one after another."""
    model = cantilever_model("hamiltonian")
    t = np.linspace(0.0, 1.0, 101)
    integrator = Integrator(method="dop853_fixed", step_s=0.01)
    starts = np.random.default_rng(0).uniform(-0.3, 0.3, (max(RESPONSES), 2)) * (1.0, 10.0)
    rows = {}
    for count in RESPONSES:

        def run(count: int = count) -> None:
            for start in starts[:count]:
                simulate(model, t, start, integrator)

        rows[count] = {"seconds": measure("datasets", f"{count} responses", run, 3, warmup=1).median_s}
    show("a dataset of the cantilever", "responses", rows, "s")


def main() -> None:
    against_elements()
    against_modes()
    weights = {4 * width + 1: (width, 1.0) for width in WIDTHS}
    training("weights", weights)
    training("samples", {share: (16, share) for share in SHARES})
    data()


if __name__ == "__main__":
    main()
