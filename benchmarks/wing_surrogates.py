"""What port-Hamiltonian surrogates of the wing and learned loads come to: errors and cost.

Run alone on the machine:  python benchmarks/wing_surrogates.py
Tip errors are the largest of 30 s of fresh free response over the peak of the tip's displacement, median
and worst of ten; under the paper's loads for 5 s, of that one response of 30 s from rest. Costs are of 30 s
of free response by Radau IIA at default tolerances, and of one call.
"""

import tempfile

import numpy as np
from numba import njit
from timing import compare
from wing import ACCURATE, FRESH, basis, datasets, starts, tip_errors, wing_model

from flexsurr.beam import loaded
from flexsurr.config.history import Power
from flexsurr.config.load import DistributedForce, Spread
from flexsurr.config.study import EvaluationSettings, Integrator, LearnedLoadSettings
from flexsurr.config.trial import PortHamiltonianNetwork, trial_of
from flexsurr.evaluation.learned_loads import exact_forces, learn_forces, relative_error
from flexsurr.simulation import rhs, simulate
from flexsurr.surrogates import LearnedLoad, compiled
from flexsurr.surrogates.monomials import differentiate, evaluate_monomials, monomials_to_degree
from flexsurr.training import fit

RESPONSES, REPEATS, CALLS = 10, 15, 5000
TIMES = np.linspace(0.0, 30.0, 3001)
MANY = "1,000 x 5"
LOAD = DistributedForce(
    along_y=Spread(force_N_m=0.5, shape="one_minus_elliptic"),
    along_z=Spread(force_N_m=2.0, shape="elliptic"),
    history=Power(exponent=2),
)
LOAD_ENDS_S = 5.0
DEFAULT = Integrator(method="radau_iia_5")
TRIALS = {
    f"polynomial, degree {degree}": trial_of(
        architecture="port_hamiltonian", degree=degree, optimiser="least_squares"
    )
    for degree in (4, 6, 8)
} | {
    "network, 32 atan": trial_of(
        architecture="port_hamiltonian", hidden=(32,), activation="atan", epochs=100
    ),
    "network of entries, 32 atan": trial_of(
        architecture="port_hamiltonian", hidden=(32,), activation="atan", epochs=300, mass_matrix="entries"
    ),
}


@njit(error_model="numpy")
def call_repeatedly(kernel, t, x, dx, work, count):
    # Each state depends on the one before, as in an integrator: no two calls overlap.
    for _ in range(count):
        rhs(kernel, t, x, dx, work)
        x[0] += 1e-15 * dx[0]


def nanoseconds(what, models, x):
    """Of one call of each compiled model, timed in turns."""
    callers = {}
    for name, model in models.items():
        arrays = x.copy(), np.empty(x.size), np.empty(model.work_size)
        callers[name] = lambda kernel=model.kernel, arrays=arrays: call_repeatedly(
            kernel, 0.1, *arrays, CALLS
        )
    timings = compare(f"right-hand side of the wing, {what}", callers, REPEATS, counts=CALLS)
    return {name: 1e9 * timing.lowest_s for name, timing in timings.items()}


def under_load(model):
    """The model with the paper's loads for 5 s."""
    return loaded(model, basis(), LOAD.until(LOAD_ENDS_S), "compiled")


def reach(found, forced) -> None:
    """How far the states go in the data and under the paper's loads: the largest of each."""
    print("largest |state|" + "".join(f"{name:>10}" for name in wing_model("hamiltonian").state_names))
    states = {name: np.concatenate([data.x_train, data.x_validation]) for name, data in found.items()}
    for name, x in {**states, "under load": forced}.items():
        print(f"{name:<15}" + "".join(f"{value:>10.3g}" for value in np.abs(x).max(axis=0)))


def surrogates(found, kind) -> dict:
    reference = wing_model("hamiltonian")
    responses = [simulate(reference, TIMES, x, ACCURATE).x for x in starts(FRESH, RESPONSES, kind)]
    start = responses[0][0]
    forced = simulate(under_load(reference), TIMES, np.zeros(6), ACCURATE).x
    print(f"initial conditions: {kind}")
    reach(found, forced)
    print(f"{'':<38} parameters  training  validation  tip: median   worst  loaded   ms for 30 s   ns a call")
    for name, dataset in found.items():
        models = {"compiled reduced model": reference}
        rows, worst = {}, {}
        for label, trial in TRIALS.items():
            if isinstance(trial, PortHamiltonianNetwork) and (kind == "joint" or dataset is not found[MANY]):
                continue  # a minute for a network, once
            with tempfile.TemporaryDirectory() as folder:
                result = fit(trial, dataset, folder)
            models[label] = compiled(result.surrogate)
            errors = tip_errors(models[label], reference, TIMES, responses)
            worst[label] = np.max(errors)
            (under,) = tip_errors(under_load(models[label]), reference, TIMES, [forced])
            rows[label] = (
                f"{result.parameters:>10} {result.train_nmse:>9.1e} {result.validation_nmse:>11.1e}"
                f" {np.median(errors):>12.1e} {worst[label]:>7.1e} {under:>7.1e}"
            )
        runs = {
            label: lambda model=model: simulate(model, TIMES, start, DEFAULT)
            for label, model in models.items()
        }
        times = compare(f"30 s of the wing, {name}, {kind}", runs, REPEATS, errors=worst)
        calls = nanoseconds(f"{name}, {kind}", models, start)
        for label in models:
            blank = f"{'':>61}"
            costs = f"{1e3 * times[label].lowest_s:>13.2f} {calls[label]:>11.0f}"
            print(f"{name + ', ' + label:<38} {rows.get(label, blank)} {costs}", flush=True)
    return models


def best_gradient(eta, forces, degree):
    """What the gradient of the best polynomial potential of `eta` misses of `forces`, relative."""
    reach, spread = np.max(np.abs(eta), axis=0), np.sqrt(np.mean(forces**2, axis=0))
    exponents = monomials_to_degree(eta.shape[1], degree)
    lowered, tensor = differentiate(exponents)
    slopes = np.einsum("sl,jli->sji", evaluate_monomials(lowered, eta / reach), tensor, optimize=True)
    matrix = (slopes / (reach * spread)[:, None]).reshape(-1, len(exponents))
    target = (forces / spread).ravel()
    norms = np.linalg.norm(matrix, axis=0)
    solution, *_ = np.linalg.lstsq(matrix / norms, target)
    return relative_error(matrix / norms @ solution, target)


def learned_loads(dataset, model) -> None:
    """The study's distributed load, learned: errors on held-out samples, and what it adds to a call."""
    settings = EvaluationSettings(load=LOAD)
    eta, held_out = dataset.x_train[:, :3], dataset.x_validation[::7, :3]
    load = settings.load
    models = {"none": model, "exact": loaded(model, basis(), load, "compiled")}
    errors = {}
    for degree, hidden in ((4, 8), (6, 16), (8, 32)):
        learned_load = LearnedLoadSettings(degree=degree, hidden=hidden)
        chosen = settings.model_copy(update={"learned_load": learned_load})
        learned = learn_forces(basis(), chosen, eta, held_out)
        exact = exact_forces(basis(), learned.load, held_out)
        for fitted in (learned.polynomial, learned.network):
            errors[fitted.form] = relative_error(fitted(held_out), exact)
            models[fitted.form] = LearnedLoad(model, fitted, (load.history,))
    found = best_gradient(eta, exact_forces(basis(), learned.load, eta), 8)
    print(f"\nthe best potential of degree 8 errs by {found:.1e}: dead forces have one")
    calls = nanoseconds("under a learned load", models, dataset.x_train[5])
    print("\nlearned load along the span   force, relative   ns more a call")
    for name in models:
        if name != "none":
            error = f"{errors[name]:.1e}" if name in errors else ""
            print(f"{name:<28} {error:>16} {calls[name] - calls['none']:>16.0f}", flush=True)


def main() -> None:
    found = datasets("hamiltonian")
    models = surrogates(found, "modal")
    learned_loads(found[MANY], models["polynomial, degree 6"])
    surrogates(datasets("hamiltonian", "joint"), "joint")


if __name__ == "__main__":
    main()
