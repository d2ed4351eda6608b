"""The wing's port-Hamiltonian surrogates from sampled configurations: no simulation before the fit.

    python benchmarks/wing_without_simulation.py

nmse on the held-out trajectories of the study (config/studies/wing.yaml), which are simulated here for that
alone. The time is that of sampling and fit together, of the processor. The tip error is the worst of ten free
responses of 30 s, over the peak. Networks give the entries of the mass matrix.
"""

import tempfile
import time

import numpy as np
from timing import record
from wing import ACCURATE, FRESH, SEED, basis, starts, tip_errors, wing_model

from flexsurr.config.study import InitialConditions
from flexsurr.config.trial import trial_of
from flexsurr.simulation import simulate
from flexsurr.storage.manifest import split_trajectories
from flexsurr.surrogates import compiled
from flexsurr.training import fit, nmse
from flexsurr.training.configuration_samples import configuration_samples

TIMES = np.linspace(0.0, 1.0, 1001)
TRAJECTORIES, TRAINING_FRACTION = 50, 0.8
RESPONSES = 10
PORT_HAMILTONIAN = {"architecture": "port_hamiltonian"}
TRIALS = {
    f"degree {degree}": PORT_HAMILTONIAN | {"degree": degree, "optimiser": "least_squares"}
    for degree in (4, 6, 8)
} | {
    f"network, {hidden} {activation}, {epochs} epochs": PORT_HAMILTONIAN
    | {"hidden": (hidden,), "activation": activation, "epochs": epochs, "mass_matrix": "entries"}
    for hidden, activation, epochs in ((32, "atan", 100), (32, "atan", 300), (48, "tanh", 300))
}


def held_out():
    """States and derivatives of the study's held-out trajectories."""
    model = wing_model("hamiltonian")
    _, numbers = split_trajectories(TRAJECTORIES, TRAINING_FRACTION, SEED)
    chosen = starts(0, TRAJECTORIES)[list(numbers)]
    x = np.concatenate([simulate(model, TIMES, x0, ACCURATE).x for x0 in chosen])
    return x, np.array([model.derivative(0.0, state) for state in x])


def main() -> None:
    x, dx = held_out()
    reference, times = wing_model("hamiltonian"), np.linspace(0.0, 30.0, 3001)
    responses = [simulate(reference, times, start, ACCURATE).x for start in starts(FRESH, RESPONSES)]
    print(f"configurations  {'surrogate':<30} parameters      s     nmse  tip error")
    for count in (500, 1000, 2000):
        seconds: dict[str, float | None] = {}
        errors: dict[str, float] = {}
        more: dict[str, dict[str, float | None]] = {}
        for label, settings in TRIALS.items():
            start = time.process_time()
            samples = configuration_samples(basis(), "hamiltonian", InitialConditions(), count)
            with tempfile.TemporaryDirectory() as folder:
                found = fit(trial_of(**settings), samples, folder).surrogate
            cpu_s = time.process_time() - start
            error = nmse(found.derivative(0.0, x), dx)
            worst = max(tip_errors(compiled(found), reference, times, responses))
            seconds[label], errors[label] = cpu_s, worst
            more[label] = {"nmse": float(error), "parameters": found.parameter_count}
            row = f"{found.parameter_count:>10} {cpu_s:>6.2f} {error:>8.1e} {worst:>10.1e}"
            print(f"{count:>14}  {label:<30} {row}", flush=True)
        record(f"the wing's surrogate from {count} configurations, sampling and fit", seconds, errors, more)


if __name__ == "__main__":
    main()
