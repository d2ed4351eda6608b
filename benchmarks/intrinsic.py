"""Two reductions of the canonical wing: in joint angles, and in intrinsic variables (docs/crossover.md).

Both are stepped by the integrator of the study `crossover` from its initial states. Errors are the largest
distance of the tip, over the peak, from the chain of `FINE` modes in joint angles. Beside them stands the
linear motion.
Run: python benchmarks/intrinsic.py
"""

from pathlib import Path

import numpy as np

from flexsurr.beam import draw_initial_conditions, reduce, reduced_order
from flexsurr.beam.intrinsic import IntrinsicModel, stretching_modes
from flexsurr.config.study import InitialConditions, Integrator, Reduction
from flexsurr.config.study_files import read_structure
from flexsurr.evaluation.operations import operations
from flexsurr.simulation import simulate

ROOT = Path(__file__).parents[1]
WING = read_structure(ROOT / "config/structures/hale_wing.yaml")
STARTS = InitialConditions(
    q_min_deg=-8.0, q_max_deg=8.0, p_min_kg_m2_s=0.0, p_max_kg_m2_s=0.0, higher_modes="as_forced"
)
SEED, FIRST, SIMULATIONS = 2024, 2_000_000, 2
T = np.linspace(0.0, 30.0, 751)
FINE = 20
TIGHT = Integrator(method="dop853", rtol=1e-8, atol=1e-10)
FIXED = Integrator(method="dop853_fixed", step_s=0.005)
STIFFNESSES_N = (1e5, 1e6)  # EA; the chain of the study does not stretch
AXIAL_MODES = (0, 2, 4)
FASTEST_RAD_S = 400.0  # what the step can follow


def basis(modes: int):
    """Mass-normalised modes of the wing, `modes` of them."""
    return reduce(WING, Reduction(modes=modes, normalisation="mass"))


def stretching(stiffness_N: float):
    """The wing with axial joints."""
    return WING.model_copy(update={"joints": (*WING.joints, "axial"), "axial_stiffness_N": stiffness_N})


def intrinsic(modes: int, axial: int, stiffness_N: float) -> IntrinsicModel:
    """The slowest modes that bend and twist, and the slowest that stretch."""
    structure = stretching(stiffness_N)
    bends, stretches = stretching_modes(structure)
    return IntrinsicModel(structure, (*bends[:modes], *stretches[:axial]))


def responses(model, states, integrator=FIXED):
    """Tips (m, 3) of the responses from the states."""
    return [model.tip(simulate(model, T, x, integrator).x) for x in states]


def far(found, exact) -> float:
    """The largest distance of tips from those that are right [% of the peak], the worst of all responses."""
    root = np.array([WING.length_m, 0.0, 0.0])
    return max(
        100.0 * np.linalg.norm(f - e, axis=1).max() / np.linalg.norm(e - root, axis=1).max()
        for f, e in zip(found, exact, strict=True)
    )


def main() -> None:
    """Print the table."""
    fine = reduced_order(basis(FINE), "hamiltonian", "compiled")
    print("| modes | model | from the fine chain [%] | from the chain of so many modes [%] | operations |")
    print("|---|---|---|---|---|")
    for modes in (3, 6, 8, 10):
        own = basis(modes)
        states = draw_initial_conditions(own, STARTS, SEED, FIRST, SIMULATIONS)
        padded = np.zeros((SIMULATIONS, 2 * FINE))
        padded[:, :modes] = states[:, :modes]
        exact = responses(fine, padded, TIGHT)
        rom = reduced_order(own, "hamiltonian", "compiled")
        reduced = responses(rom, states)
        _row(modes, "joint angles", reduced, exact, reduced, operations(rom, states[0]))
        linear = intrinsic(modes, 0, STIFFNESSES_N[0])
        for stiffness_N in STIFFNESSES_N:
            for axial in AXIAL_MODES[stiffness_N != STIFFNESSES_N[0] :]:
                model = intrinsic(modes, axial, stiffness_N)
                if model.kernel.omega.max() > FASTEST_RAD_S:
                    continue
                q = states[:, :modes] @ own.modes.T
                stretched = np.hstack([q, np.zeros((SIMULATIONS, WING.elements))])
                starts = np.array([model.at_rest(one) for one in stretched])
                found = responses(model, starts)
                name = f"intrinsic, {axial} axial, {stiffness_N:g} N, {len(model.kernel.weights)} products"
                _row(modes, name, found, exact, reduced, operations(model, starts[0]))
        omega = linear.kernel.omega
        swung = [
            np.hstack([np.cos(np.outer(T, omega)) * s[:modes], np.zeros((len(T), modes))]) for s in states
        ]
        _row(modes, "linear", [rom.tip(x) for x in swung], exact, reduced, None)


def _row(modes, name, found, exact, reduced, count) -> None:
    values = f"{far(found, exact):.3g} | {far(found, reduced):.3g} | {count}"
    print(f"| {modes} | {name} | {values} |", flush=True)


if __name__ == "__main__":
    main()
