"""How costs grow: of models with elements and modes, of training with samples and weights, of data.

    python benchmarks/scaling.py

Each table ends with the exponent of a power law that is fitted to its last three rows, least squares of the
logarithms: what a further doubling will cost. Surrogates of the cantilever are fitted anew to each number of
elements, without a simulation.
"""

import logging
import resource
import tempfile
import time
from collections.abc import Iterable
from pathlib import Path

import numpy as np
import yaml
from beam_right_hand_sides import COMPILED, COMPILED_CALLS, KINDS, caller
from cantilever import STRUCTURE, cantilever_dataset
from chosen import study_of
from timing import More, compare, record
from wing import STRUCTURE as WING

from flexsurr.beam import full_order, reduce, reduced_order
from flexsurr.beam.projection import Projection
from flexsurr.cli.trajectories import simulate as simulate_shard
from flexsurr.config.settings import load
from flexsurr.config.structure import Structure
from flexsurr.config.study import Reduction
from flexsurr.config.trial import trial_of
from flexsurr.surrogates import (
    CompiledSurrogate,
    NetworkPortHamiltonian,
    PairScaling,
    PolynomialPortHamiltonian,
    compiled,
)
from flexsurr.surrogates.monomials import monomials_to_degree
from flexsurr.surrogates.packed import pack, packed_size
from flexsurr.training import fit
from flexsurr.training.configuration_samples import configuration_samples
from flexsurr.workflow.plan import Plan

ELEMENTS = (10, 20, 40, 80, 160, 320)
MODES = (1, 2, 4, 6, 8, 10)
WIDTHS = (8, 16, 32, 64)
SHARES = (0.125, 0.25, 0.5, 1.0)
TRAJECTORIES = (100, 10_000, 1_000_000)
IN_A_SHARD = 10_000
CONFIGURATIONS = 500
WIDTH = 64
"""Neurons of the network of several modes."""
REPEATS = 5
OF_FULL_ORDER, OF_SURROGATES = 200, 100_000
"""Calls in a turn: a small kernel's first thousands find the caches as another model has left them."""
OF_CANTILEVER = {
    "polynomial, degree 6": {"architecture": "polynomial", "degree": 6, "optimiser": "least_squares"},
    "HNN, 16": {"architecture": "hnn", "hidden": (16,), "activation": "half_log", "epochs": 60},
}


def exponent(sizes: list[float], costs: list[float]) -> float:
    """From the last three."""
    return float(np.polyfit(np.log(sizes[-3:]), np.log(costs[-3:]), 1)[0])


def show(what: str, against: str, rows: dict[float, dict[str, float]], unit: str) -> None:
    """A table of costs against sizes, and under it the exponents, which are kept."""
    names = list(next(iter(rows.values())))
    print(f"\n{what} [{unit}]\n{against:>12}" + "".join(f"{name:>24}" for name in names))
    for number, costs in rows.items():
        print(f"{number:>12g}" + "".join(f"{costs[name]:>24.4g}" for name in names))
    powers = {name: exponent(list(rows), [costs[name] for costs in rows.values()]) for name in names}
    print(f"{'exponent':>12}" + "".join(f"{powers[name]:>24.2f}" for name in names), flush=True)
    more = {name: {"against": against, "exponent": power} for name, power in powers.items()}
    record(f"{what}: growth with {against}", dict.fromkeys(names), more=more)


def sized(what: str, against: str, size: float, names: Iterable[str]) -> tuple[str, More]:
    """What a row of one size says."""
    return f"{what}, {against}: {size:g}", {name: {"against": against, "size": size} for name in names}


def against_elements() -> None:
    cantilever = Structure(**yaml.safe_load(STRUCTURE.read_text()))
    rows = {}
    for elements in ELEMENTS:
        structure = cantilever.model_copy(update={"elements": elements})
        basis = reduce(structure, Reduction(modes=1))
        callers = {
            f"reduced, {kind}": caller(reduced_order(basis, "hamiltonian", kind), kind) for kind in KINDS
        }
        full = full_order(structure, "hamiltonian", COMPILED)
        callers["full order, compiled"] = caller(full, COMPILED, OF_FULL_ORDER)
        counts = {f"reduced, {COMPILED}": COMPILED_CALLS, "full order, compiled": OF_FULL_ORDER}
        for name, model in surrogates_for(basis).items():
            callers[name] = caller(model, COMPILED, OF_SURROGATES)
            counts[name] = OF_SURROGATES
        what, more = sized("right-hand side of the cantilever", "elements", elements, callers)
        timings = compare(what, callers, REPEATS, counts=counts, more=more)
        rows[elements] = {name: 1e6 * timing.median_s for name, timing in timings.items()}
    show("right-hand side of the cantilever", "elements", rows, "µs")


def surrogates_for(basis: Projection) -> dict[str, CompiledSurrogate]:
    """Surrogates of one mode of the cantilever with so many elements."""
    study = study_of("cantilever", basis.structure.elements / ELEMENTS[0])
    samples = configuration_samples(basis, "hamiltonian", study.dataset.initial_conditions, CONFIGURATIONS)
    found = {}
    for name, settings in OF_CANTILEVER.items():
        with tempfile.TemporaryDirectory() as folder:
            found[name] = compiled(fit(trial_of(**settings), samples, Path(folder)).surrogate)
    return found


def against_modes() -> None:
    rows = {}
    for modes in MODES:
        basis = reduce(WING, Reduction(modes=modes, normalisation="mass"))
        callers = {
            f"reduced, {kind}": caller(reduced_order(basis, "hamiltonian", kind), kind) for kind in KINDS
        }
        surrogates = {name: caller(model, COMPILED) for name, model in surrogates_of(modes).items()}
        counts = dict.fromkeys((f"reduced, {COMPILED}", *surrogates), COMPILED_CALLS)
        callers |= surrogates
        what, more = sized("right-hand side of the wing", "modes", modes, callers)
        timings = compare(what, callers, REPEATS, counts=counts, more=more)
        rows[modes] = {name: 1e6 * timing.median_s for name, timing in timings.items()}
    show("right-hand side of the wing", "modes", rows, "µs")


def surrogates_of(modes: int) -> dict[str, CompiledSurrogate]:
    """Surrogates of so many modes with a mass matrix near the identity; other weights make no difference."""
    generator = np.random.default_rng(0)
    entries, unit = packed_size(modes), pack(np.eye(modes))
    names = tuple(f"{name}_{k}" for name in ("eta", "p") for k in range(modes))
    common = PairScaling((1.0,) * modes, 1.0, 1.0), names, ("1",) * (2 * modes)
    exponents = np.concatenate([np.zeros((1, modes), dtype=np.int64), monomials_to_degree(modes, 4)])
    exponents = exponents[exponents.sum(axis=1) % 2 == 0]
    mass = 1e-3 * generator.normal(size=(entries, len(exponents)))
    mass[:, 0] = unit
    coefficients = np.concatenate([mass.ravel(), unit, unit])
    inputs = sum(int(np.prod(shape)) for shape in NetworkPortHamiltonian.shapes(modes, WIDTH, True))
    return {
        "polynomial, degree 4": compiled(
            PolynomialPortHamiltonian(coefficients, *common, exponents=exponents)
        ),
        f"network of entries, {WIDTH}": compiled(
            NetworkPortHamiltonian(
                1e-3 * generator.normal(size=inputs),
                *common,
                floor=unit,
                even=True,
                hidden=(WIDTH,),
                activation="atan",
                factored=False,
            )
        ),
    }


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
        many = number if size == "weights" else len(chosen)
        seconds = result.wall_s / result.epochs
        what, more = sized("training of an HNN", size, many, ["one epoch"])
        record(what, {"one epoch": seconds}, more=more)
        rows[many] = {"one epoch": 1e3 * seconds}
    show("training of an HNN", size, rows, "ms")


def data() -> None:
    """Free responses of 1 s, five samples of each, in shards as the workflow makes them, on one core."""
    logging.disable()
    root = Path(__file__).parents[1]
    job = Plan(load(root, [root / "config/config.yaml"])).studies["cantilever"].simulate("hamiltonian", 0)
    job["part"]["dataset"] |= {"duration_s": 1.0, "step_s": 0.25}
    rows = {}
    for count in TRAJECTORIES:
        with tempfile.TemporaryDirectory() as folder:
            begin = time.perf_counter()
            for first in range(0, count, IN_A_SHARD):
                part = {"first": first, "count": min(IN_A_SHARD, count - first)}
                simulate_shard(job | part, Path(folder) / f"shard-{first:07d}.parquet")
            seconds = time.perf_counter() - begin
            files = list(Path(folder).iterdir())
            megabytes = sum(file.stat().st_size for file in files) / 1e6
        # the most that this process has ever held
        held = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0
        rows[count] = {"seconds": seconds, "files": len(files), "MB of files": megabytes, "MB held": held}
        known = {"files": len(files), "files_MB": megabytes, "held_MB": held}
        what, more = sized("dataset of the cantilever", "trajectories", count, ["one core"])
        record(what, {"one core": seconds}, more={"one core": dict(more["one core"]) | known})
    show("dataset of the cantilever", "trajectories", rows, "s; MB")


def main() -> None:
    against_elements()
    against_modes()
    weights = {4 * width + 1: (width, 1.0) for width in WIDTHS}
    training("weights", weights)
    training("samples", {share: (16, share) for share in SHARES})
    data()


if __name__ == "__main__":
    main()
