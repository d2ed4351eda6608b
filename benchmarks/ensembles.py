"""What ten thousand free responses of 30 s cost, by thread and by surrogate.

Run alone on the machine:  python benchmarks/ensembles.py
Of the cantilever at fixed steps of order 8, trajectories side by side. Surrogates are fitted to the study's
data. Errors are the worst of two hundred responses. Of the steps: final states against short steps of the
same surrogate, over the largest state. Of the tip within the 30 s: against the reduced model by short steps,
over the peak of its displacement. Then a thousand of the damped wing by Radau IIA, one by one.
"""

import os
import tempfile
from pathlib import Path

import numpy as np
from cantilever import SEED, cantilever_dataset, cantilever_model
from timing import Timing, compare
from wing import FRESH, basis, starts, wing_model

from flexsurr.config.study import InitialConditions, Integrator
from flexsurr.config.trial import trial_of
from flexsurr.simulation import simulate, simulate_ensemble
from flexsurr.surrogates import compiled
from flexsurr.training import fit
from flexsurr.training.configuration_samples import configuration_samples
from flexsurr.training.inverse_dynamics import fit_port_hamiltonian

RESPONSES, CHECKED, DURATION_S = 10_000, 200, 30.0
ENDS = np.array([0.0, DURATION_S])
STEPS_S = (0.01, 0.015, 0.02)
SEEN = np.linspace(0.0, DURATION_S, 501)
"""Times of the tip: a whole number of any of the steps apart."""
TIGHT = Integrator(method="dop853_fixed", step_s=0.002)
NETWORK = {"activation": "half_log", "epochs": 400, "patience": 60}
TRIALS = {
    "polynomial H, degree 6": trial_of(architecture="polynomial", degree=6, optimiser="least_squares"),
    "polynomial H, degree 10": trial_of(architecture="polynomial", degree=10, optimiser="least_squares"),
    "even HNN, 8 neurons": trial_of(architecture="even_hnn", hidden=(8,), **NETWORK),
    "HNN, 16 neurons": trial_of(architecture="hnn", hidden=(16,), **NETWORK),
}
ONE_BY_ONE = "polynomial H, degree 6"
"""Whose responses are also simulated in a call each."""
CORES = len(os.sched_getaffinity(0))
OF_WING, CONFIGURATIONS = 1_000, 1_000
STIFF = Integrator(method="radau_iia_5", rtol=1e-3, atol=1e-6)


def last(numbers, x):
    return x[:, -1]


def shown(walls: dict[str, Timing]) -> str:
    return "".join(f"{timing!s:>18}" for timing in walls.values())


def cantilever() -> None:
    dataset = cantilever_dataset("hamiltonian")
    ranges = InitialConditions()
    reach = np.radians(ranges.q_max_deg)
    starts = np.random.default_rng(SEED).uniform([-reach, 0.0], [reach, 1.5], (RESPONSES, 2))
    print(f"{RESPONSES} free responses of {DURATION_S:g} s of the cantilever, order 8; wall time by threads")
    print(f"{'':<26}{'step s':>8}{1:>18}{CORES:>18}{'of steps':>10}{'of the tip %':>14}")
    reference = cantilever_model("hamiltonian")
    at_rest = reference.tip(np.zeros(2))
    tips = reference.tip(simulate_ensemble(reference, SEEN, starts[:CHECKED], TIGHT).kept)
    peaks = np.linalg.norm(tips - at_rest, axis=-1).max(axis=1)
    for name, trial in TRIALS.items():
        with tempfile.TemporaryDirectory() as folder:
            model = compiled(fit(trial, dataset, Path(folder)).surrogate)
        exact = simulate_ensemble(model, ENDS, starts[:CHECKED], TIGHT, observe=last).kept
        for step_s in STEPS_S:
            integrator = Integrator(method="dop853_fixed", step_s=step_s)

            def run(threads, model=model, integrator=integrator):
                return simulate_ensemble(model, ENDS, starts, integrator, observe=last, threads=threads)

            found = run(CORES).kept[:CHECKED]
            error = float((np.abs(found - exact) / np.abs(exact).max(axis=0)).max())
            seen = simulate_ensemble(model, SEEN, starts[:CHECKED], integrator).kept
            of_tip = float((np.linalg.norm(reference.tip(seen) - tips, axis=-1).max(axis=1) / peaks).max())
            runs = {f"threads: {n}": lambda n=n: run(n) for n in (1, CORES)}
            work = f"{RESPONSES} responses of {name}, step {step_s} s"
            if name == ONE_BY_ONE and step_s == STEPS_S[0]:
                runs["one by one"] = lambda model=model, i=integrator: [
                    simulate(model, ENDS, x0, i) for x0 in starts
                ]
            errors = dict.fromkeys(runs, of_tip)
            more = {case: {"error_of_steps": error} for case in runs}
            walls = compare(work, runs, repeats=5, warmup=1, errors=errors, more=more)
            print(f"{name:<26}{step_s:>8}{shown(walls)}{error:>10.0e}{100 * of_tip:>14.2g}", flush=True)


def wing() -> None:
    x0 = starts(FRESH, OF_WING)
    samples = configuration_samples(basis(), "hamiltonian", InitialConditions(), CONFIGURATIONS)
    models = {"reduced model": wing_model("hamiltonian")}
    models |= {f"degree {n}": compiled(fit_port_hamiltonian(samples, n)) for n in (4, 6, 8)}
    print(f"{OF_WING} of the wing, Radau IIA, rtol 1e-3")
    for name, model in models.items():

        def run(threads, model=model):
            return simulate_ensemble(model, ENDS, x0, STIFF, observe=last, threads=threads)

        runs = {f"threads: {n}": lambda n=n: run(n) for n in (1, CORES)}
        walls = compare(f"{OF_WING} responses of the wing, {name}", runs, repeats=3, warmup=1)
        print(f"{name:<34}{shown(walls)}", flush=True)


def main() -> None:
    cantilever()
    wing()


if __name__ == "__main__":
    main()
