"""What ten thousand free responses of 30 s cost, by thread and by surrogate.

Run alone on the machine:  python benchmarks/ensembles.py
Of the cantilever at fixed steps of order 8, trajectories side by side. Surrogates are fitted to the study's
data; errors are those of the steps: the largest of the final states of a thousand responses, over the largest
state, against short steps of the same surrogate. Then a thousand of the damped wing by Radau IIA, one by one.
"""

import os
import tempfile
from pathlib import Path

import numpy as np
from cantilever import SEED, cantilever_dataset
from timing import Timing, compare
from wing import FRESH, basis, starts, wing_model

from flexsurr.config.study import InitialConditions, Integrator
from flexsurr.config.trial import trial_of
from flexsurr.simulation import simulate_ensemble
from flexsurr.surrogates import compiled
from flexsurr.training import fit
from flexsurr.training.configuration_samples import configuration_samples
from flexsurr.training.inverse_dynamics import fit_port_hamiltonian

RESPONSES, CHECKED, DURATION_S = 10_000, 1_000, 30.0
ENDS = np.array([0.0, DURATION_S])
STEPS_S = (0.01, 0.015, 0.02)
TIGHT = Integrator(method="dop853_fixed", step_s=0.002)
NETWORK = {"activation": "half_log", "epochs": 400}
TRIALS = {
    "polynomial H, degree 6": trial_of(architecture="polynomial", degree=6, optimiser="least_squares"),
    "polynomial H, degree 10": trial_of(architecture="polynomial", degree=10, optimiser="least_squares"),
    "even HNN, 4 neurons": trial_of(architecture="even_hnn", hidden=(4,), **NETWORK),
    "even HNN, 8 neurons": trial_of(architecture="even_hnn", hidden=(8,), **NETWORK),
    "HNN, 16 neurons": trial_of(architecture="hnn", hidden=(16,), **NETWORK),
}


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
    print(f"{'':<26}{'step s':>8}{1:>18}{CORES:>18}{'error':>10}")
    for name, trial in TRIALS.items():
        with tempfile.TemporaryDirectory() as folder:
            model = compiled(fit(trial, dataset, Path(folder)).surrogate)
        exact = simulate_ensemble(model, ENDS, starts[:CHECKED], TIGHT, observe=last).kept
        for step_s in STEPS_S:
            integrator = Integrator(method="dop853_fixed", step_s=step_s)

            def run(threads, model=model, integrator=integrator):
                return simulate_ensemble(model, ENDS, starts, integrator, observe=last, threads=threads)

            found = run(CORES).kept[:CHECKED]
            error = (np.abs(found - exact) / np.abs(exact).max(axis=0)).max()
            runs = {f"threads: {n}": lambda n=n: run(n) for n in (1, CORES)}
            walls = compare(f"{RESPONSES} responses of {name}, step {step_s} s", runs, repeats=5, warmup=1)
            print(f"{name:<26}{step_s:>8}{shown(walls)}{error:>10.0e}", flush=True)


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
