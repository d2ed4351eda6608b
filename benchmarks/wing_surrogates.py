"""What port-Hamiltonian surrogates of the wing and learned loads come to: errors and cost.

Run alone on the machine:  python benchmarks/wing_surrogates.py
Tip errors are the largest of 30 s of fresh free response over the peak of the tip's displacement, median
and worst of ten. Costs are of 30 s of free response by Radau IIA at default tolerances, and of one call.
"""

import tempfile

import numpy as np
from numba import njit
from timing import compare
from wing import ACCURATE, FRESH, STRUCTURE, basis, datasets, starts, wing_model

from flexsurr.beam import SineTipForce, element_frames, loaded, tip_position
from flexsurr.config.study import Integrator
from flexsurr.config.sweep import Trial
from flexsurr.simulation import rhs, simulate
from flexsurr.surrogates import LearnedLoad, compiled
from flexsurr.training import fit, fit_network_map, fit_polynomial_map

RESPONSES, REPEATS, CALLS = 10, 15, 5000
TIMES = np.linspace(0.0, 30.0, 3001)
MANY = "1,000 x 5"
DEFAULT = Integrator(method="radau_iia_5")
TRIALS = {
    f"polynomial, degree {degree}": Trial(
        architecture="port_hamiltonian", degree=degree, optimiser="least_squares"
    )
    for degree in (4, 6, 8)
} | {"network, 32 atan": Trial(architecture="port_hamiltonian", hidden=(32,), activation="atan", epochs=100)}
NAMES = ("x", "y", "z", "cosine", "sine")


@njit(error_model="numpy")
def call_repeatedly(kernel, t, x, dx, work, count):
    # Each state depends on the one before, as in an integrator: no two calls overlap.
    for _ in range(count):
        rhs(kernel, t, x, dx, work)
        x[0] += 1e-15 * dx[0]


def nanoseconds(models, x):
    """Of one call of each compiled model, timed in turns."""
    callers = {}
    for name, model in models.items():
        arrays = x.copy(), np.empty(x.size), np.empty(model.work_size)
        callers[name] = lambda kernel=model.kernel, arrays=arrays: call_repeatedly(
            kernel, 0.1, *arrays, CALLS
        )
    return {name: 1e9 * timing.lowest_s / CALLS for name, timing in compare(callers, REPEATS).items()}


def tip_errors(model, reference, responses):
    """Of each response, relative to its peak; infinite where it fails."""
    at_rest, errors = reference.tip(np.zeros(6)), []
    for exact in responses:
        found = simulate(model, TIMES, exact[0], ACCURATE)
        if not found.completed:
            errors.append(np.inf)
            continue
        peak = np.max(np.linalg.norm(reference.tip(exact) - at_rest, axis=1))
        distance = np.linalg.norm(reference.tip(found.x) - reference.tip(exact), axis=1)
        errors.append(np.max(distance) / peak)
    return errors


def surrogates(found) -> dict:
    reference = wing_model("hamiltonian")
    responses = [simulate(reference, TIMES, x, ACCURATE).x for x in starts(FRESH, RESPONSES)]
    start = responses[0][0]
    print(f"{'':<38} parameters  training  validation  tip: median   worst   ms for 30 s   ns a call")
    for name, dataset in found.items():
        models = {"compiled reduced model": reference}
        rows = {}
        for label, trial in TRIALS.items():
            if trial.hidden and dataset is not found[MANY]:
                continue  # a minute for a network, once
            with tempfile.TemporaryDirectory() as folder:
                result = fit(trial, dataset, folder)
            models[label] = compiled(result.surrogate)
            errors = tip_errors(models[label], reference, responses)
            rows[label] = (
                f"{result.parameters:>10} {result.train_nmse:>9.1e} {result.validation_nmse:>11.1e}"
                f" {np.median(errors):>12.1e} {np.max(errors):>7.1e}"
            )
        runs = {
            label: lambda model=model: simulate(model, TIMES, start, DEFAULT)
            for label, model in models.items()
        }
        times, calls = compare(runs, REPEATS), nanoseconds(models, start)
        for label in models:
            blank = f"{'':>53}"
            costs = f"{1e3 * times[label].lowest_s:>13.2f} {calls[label]:>11.0f}"
            print(f"{name + ', ' + label:<38} {rows.get(label, blank)} {costs}", flush=True)
    return models


def outputs(eta):
    """Tip's position and the cosine and sine of its twist."""
    q = eta @ basis().modes.T
    frames = element_frames(STRUCTURE, q)[:, -1]
    return np.column_stack([tip_position(STRUCTURE, q), frames[:, 1, 1], frames[:, 2, 1]])


def learned_loads(dataset, model) -> None:
    load = SineTipForce(10.0, 50.0, start_s=0.0)
    eta, held_out = dataset.x_train[:, :3], dataset.x_validation[::7, :3]
    force = np.array([0.0, 0.0, 10.0, 0.0, 0.0])
    h = 1e-5
    jacobian = np.stack(
        [(outputs(held_out + h * e) - outputs(held_out - h * e)) / (2 * h) for e in np.eye(3)], axis=-1
    )
    expected, exact = outputs(held_out), np.einsum("smk,m->sk", jacobian, force)
    maps = {f"polynomial, degree {d}": fit_polynomial_map(eta, outputs(eta), NAMES, d) for d in (4, 6, 8)}
    maps |= {f"network, {n}": fit_network_map(eta, outputs(eta), NAMES, n, "atan", 100) for n in (16, 32)}
    models = {"none": model, "exact": loaded(model, basis(), load, "compiled")}
    models |= {name: LearnedLoad(model, learned, force, load.history) for name, learned in maps.items()}
    calls = nanoseconds(models, dataset.x_train[5])
    print(
        "\nlearned load at the tip   position rms / L   force, relative   twist, largest rad   ns more a call"
    )
    print(f"{'exact':<26} {'':>54} {calls['exact'] - calls['none']:>15.0f}")
    for name, learned in maps.items():
        off = np.sum((learned(held_out) - expected)[:, :3] ** 2, axis=1)
        forces = np.linalg.norm(learned.generalised_force(held_out, force) - exact) / np.linalg.norm(exact)
        turn = learned.angle(held_out, "sine", "cosine") - np.arctan2(expected[:, 4], expected[:, 3])
        twist = np.max(np.abs(np.angle(np.exp(1j * turn))))
        print(
            f"{name:<26} {np.sqrt(np.mean(off)) / STRUCTURE.length_m:>15.1e} {forces:>17.1e}"
            f" {twist:>20.1e} {calls[name] - calls['none']:>15.0f}",
            flush=True,
        )


def main() -> None:
    found = datasets("hamiltonian")
    models = surrogates(found)
    learned_loads(found[MANY], models["polynomial, degree 6"])


if __name__ == "__main__":
    main()
