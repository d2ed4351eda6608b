"""The wing's port-Hamiltonian polynomials from sampled configurations: no simulation before the fit.

    python benchmarks/wing_without_simulation.py

nmse on the held-out trajectories of the study (config/studies/wing.yaml), which are simulated here for that
alone. The time is that of sampling and fit together, of the processor.
"""

import time

import numpy as np
from wing import ACCURATE, SEED, basis, starts, wing_model

from flexsurr.config.study import InitialConditions
from flexsurr.simulation import simulate
from flexsurr.storage.manifest import split_trajectories
from flexsurr.training import nmse
from flexsurr.training.configuration_samples import configuration_samples
from flexsurr.training.inverse_dynamics import fit_port_hamiltonian

TIMES = np.linspace(0.0, 1.0, 1001)
TRAJECTORIES, TRAINING_FRACTION = 50, 0.8


def held_out():
    """States and derivatives of the study's held-out trajectories."""
    model = wing_model("hamiltonian")
    _, numbers = split_trajectories(TRAJECTORIES, TRAINING_FRACTION, SEED)
    chosen = starts(0, TRAJECTORIES)[list(numbers)]
    x = np.concatenate([simulate(model, TIMES, x0, ACCURATE).x for x0 in chosen])
    return x, np.array([model.derivative(0.0, state) for state in x])


def main() -> None:
    x, dx = held_out()
    print("configurations  degree  parameters      s     nmse")
    for count in (500, 1000, 2000):
        for degree in (4, 6, 8):
            start = time.process_time()
            samples = configuration_samples(basis(), "hamiltonian", InitialConditions(), count)
            found = fit_port_hamiltonian(samples, degree)
            cpu_s = time.process_time() - start
            error = nmse(found.derivative(0.0, x), dx)
            print(f"{count:>14} {degree:>7} {found.parameter_count:>11} {cpu_s:>6.2f} {error:>8.1e}")


if __name__ == "__main__":
    main()
