"""What the frequencies of a structure ask of its study: durations, steps, ranges, integrators.

python examples/choose.py config/structures/wing.yaml --modes 3
python examples/choose.py config/structures/wing.yaml --modes 3 --try

The second also simulates, and says what each integrator costs and errs by. docs/choosing.md has the reasons.
"""

import argparse
import math
from pathlib import Path
from time import perf_counter

import numpy as np

from flexsurr.beam import ModalBasis, natural_modes, reduce, reduced_order, tip_position
from flexsurr.config.structure_file import read_structure
from flexsurr.config.study import InitialConditions, Integrator, Reduction
from flexsurr.simulation import simulate

STABLE = 5.0
"""Decay rate times step that the explicit method of order 8 bears; rk4 bears 2.8."""


def plain(number: float) -> float:
    """The largest of 1, 2 and 5 times a power of ten that is not above `number`."""
    power = 10.0 ** math.floor(math.log10(number))
    return float(f"{max(digit for digit in (1, 2, 5) if digit * power <= number * (1 + 1e-9)) * power:.1g}")


def decay_rates(basis: ModalBasis) -> np.ndarray:
    """(2 r,) rates [1/s] at which free motion about the undeformed shape dies out; 0 without damping."""
    r = len(basis.omega_rad_s)
    system = np.block([[np.zeros((r, r)), np.eye(r)], [-basis.stiffness, -basis.damping]])
    return np.sort(-np.linalg.eigvals(system).real)


def main(path: Path, modes: int, q_max_deg: float, simulates: bool) -> None:
    """Print the frequencies, and what follows from them."""
    structure = read_structure(path)
    basis = reduce(structure, Reduction(modes=modes, normalisation="mass"))
    rates = decay_rates(basis)
    q_max = math.radians(q_max_deg)
    at_rest = tip_position(structure, np.zeros(structure.coordinates))
    print("mode  rad/s      period s   damping     tip at q_max, of the length   p_max kg m²/s")
    for k, (omega, norm) in enumerate(zip(basis.omega_rad_s, basis.unit_norms, strict=True)):
        tip = tip_position(structure, basis.modes[:, k] / norm * q_max) - at_rest
        damping = basis.damping[k, k] / (2.0 * omega)
        print(
            f"{k + 1:<5} {omega:<10.4g} {2 * math.pi / omega:<11.4g}{damping:<12.3g}"
            f"{np.linalg.norm(tip) / structure.length_m:<30.3g}{omega * q_max / norm**2:.3g}"
        )
    full, _ = natural_modes(structure, np.zeros(structure.coordinates))
    print(f"full order: up to {full[-1]:.3g} rad/s")

    slowest, fastest = 2.0 * math.pi / basis.omega_rad_s[[0, -1]]
    between, step = plain(fastest / 20.0), plain(fastest / 10.0)
    stiff = rates[-1] * step > STABLE
    lasting = rates[rates > 1e-9 * basis.omega_rad_s[0]]
    long = 100.0 * slowest if lasting.size == 0 else min(100.0 * slowest, math.log(100.0) / lasting[0])
    print("\ndataset:")
    print(f"  duration_s: {round(2.0 * slowest / between) * between:.6g}")
    print(f"  step_s: {between:g}")
    # one range for all modes: that of the mode which moves the least mass
    momentum = plain(float(np.min(basis.omega_rad_s * q_max / basis.unit_norms**2)))
    print(
        f"  initial_conditions: {{q_min_deg: {-q_max_deg}, q_max_deg: {q_max_deg}, "
        f"p_min_kg_m2_s: {-momentum:g}, p_max_kg_m2_s: {momentum:g}}}"
    )
    chosen = (
        Integrator(method="radau_iia_5", rtol=1e-7, atol=1e-9)
        if stiff
        else Integrator(method="dop853_fixed", step_s=step)
    )
    print("evaluation:")
    print(f"  duration_s: {max(round(plain(long) / step), 1) * step:.6g}")
    print(f"  output_step_s: {step:g}")
    print(f"  judging_integrator: {chosen.label}")
    print(f"fastest decay {rates[-1]:.3g} 1/s: {'stiff' if stiff else 'not stiff'}")
    if simulates:
        compare(
            basis, InitialConditions(q_max_deg=q_max_deg, p_max_kg_m2_s=momentum), fastest, slowest, stiff
        )


def compare(
    basis: ModalBasis, ranges: InitialConditions, fastest: float, slowest: float, stiff: bool
) -> None:
    """Ten periods from the corner of the ranges, by several integrators, against a tight one."""
    model = reduced_order(basis, "hamiltonian", "compiled")
    r = len(basis.omega_rad_s)
    q = np.full(r, math.radians(ranges.q_max_deg)) / basis.unit_norms
    x0 = np.concatenate([q, np.full(r, ranges.p_max_kg_m2_s) * basis.unit_norms])
    # no step is longer than from one sample to the next
    t = np.linspace(0.0, 10.0 * slowest, round(10.0 * slowest / fastest * 5.0) + 1)
    tight = Integrator(method="radau_iia_5" if stiff else "dop853", rtol=1e-11, atol=1e-13)
    reference = model.tip(simulate(model, t, x0, tight).x)
    peak = np.linalg.norm(reference - [basis.structure.length_m, 0.0, 0.0], axis=1).max()
    print(f"\nten periods, the tip moves by up to {peak / basis.structure.length_m:.2f} of the length")
    if stiff:
        tried = [Integrator(method="radau_iia_5", rtol=10.0**-k, atol=10.0 ** -(k + 2)) for k in (3, 5, 7)]
    else:
        tried = [Integrator(method="dop853_fixed", step_s=fastest / k) for k in (5, 10, 20)]
        tried += [Integrator(method="rk4", step_s=fastest / k) for k in (50, 100)]
        tried += [Integrator(method="gauss_legendre_6", step_s=fastest / k) for k in (10, 20)]
    for integrator in tried:
        simulate(model, t, x0, integrator)  # compiles it
        start = perf_counter()
        found = simulate(model, t, x0, integrator)
        spent = perf_counter() - start
        error = np.linalg.norm(model.tip(found.x) - reference, axis=1).max() / peak
        print(f"{integrator.label:<40} {1e3 * spent:8.2f} ms  tip error {100 * error:.2g} %")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    cantilever = Path(__file__).parents[1] / "config" / "structures" / "cantilever.yaml"
    parser.add_argument("structure", type=Path, nargs="?", default=cantilever, help="its file")
    parser.add_argument("--modes", type=int, default=1, help="that are kept")
    parser.add_argument(
        "--q-max", type=float, default=20.0, metavar="DEG", help="amplitude of unit-norm modes"
    )
    parser.add_argument(
        "--try", action="store_true", dest="simulates", help="simulate with several integrators"
    )
    given = parser.parse_args()
    main(given.structure, given.modes, given.q_max, given.simulates)
