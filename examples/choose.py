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

from flexsurr.beam import natural_modes, reduce, reduced_order
from flexsurr.beam.initial_conditions import initial_states
from flexsurr.config.study import Integrator, Reduction
from flexsurr.config.study_files import read_structure
from flexsurr.evaluation.choice import Choice
from flexsurr.simulation import simulate


def main(path: Path, modes: int, q_max_deg: float | None, simulates: bool) -> None:
    """Print the frequencies, and what follows from them."""
    structure = read_structure(path)
    basis = reduce(structure, Reduction(modes=modes, normalisation="mass"))
    choice = Choice(basis, q_max_deg)
    print("mode  rad/s      period s   damping     q_max °   tip, L or rad   energy at one amplitude")
    ends = np.degrees(np.diag(choice.ends) * basis.unit_norms)
    springs = np.diag(basis.stiffness) / basis.unit_norms**2
    for k, omega in enumerate(basis.omega_rad_s):
        damping = basis.damping[k, k] / (2.0 * omega)
        print(
            f"{k + 1:<5} {omega:<10.4g} {2 * math.pi / omega:<11.4g}{damping:<12.3g}"
            f"{ends[k]:<10.3g}{choice.reaches[k]:<16.3g}{springs[k] / springs[0]:.3g}"
        )
    full, _ = natural_modes(structure, np.zeros(structure.coordinates))
    print(f"full order: up to {full[-1]:.3g} rad/s")

    starts = choice.initial_conditions.model_dump(exclude={"kind"})
    print("\ndataset:")
    print(f"  duration_s: {choice.sampled_s:.6g}")
    print(f"  step_s: {choice.sample_step_s:g}")
    print("  initial_conditions: {" + ", ".join(f"{key}: {value}" for key, value in starts.items()) + "}")
    print("evaluation:")
    print(f"  duration_s: {choice.response_s():.6g}")
    print(f"  output_step_s: {choice.output_step_s:g}")
    print(f"  judging_integrator: {choice.integrator.label}")
    print(f"fastest decay {choice.decay_rates[-1]:.3g} 1/s: {'stiff' if choice.stiff else 'not stiff'}")
    if simulates:
        compare(choice)


def compare(choice: Choice) -> None:
    """Ten periods from the corner of the ranges, by several integrators, against a tight one."""
    basis, fastest, slowest, stiff = choice.basis, choice.fastest_s, choice.slowest_s, choice.stiff
    model = reduced_order(basis, "hamiltonian", "compiled")
    r = len(basis.omega_rad_s)
    (x0,) = initial_states(basis, choice.initial_conditions, np.ones((1, 2 * r)))
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
        "--q-max", type=float, metavar="DEG", help="amplitude of the first mode, of unit norm"
    )
    parser.add_argument(
        "--try", action="store_true", dest="simulates", help="simulate with several integrators"
    )
    given = parser.parse_args()
    main(given.structure, given.modes, given.q_max, given.simulates)
