"""Configurations that a structure's motion visits, without a simulation: where linear motion takes it.

Configurations wander beyond the range of their initial ones, and not evenly: dampers couple the modes. All
that the sum of the energies allows is far wider still, for little of it ever goes from one mode into another,
and a polynomial that has to hold there is worse where the structure is. So initial states follow the linear
equations about the equilibrium,

    M ξ̈ + C ξ̇ + K ξ = 0,   η = equilibrium + ξ,

in closed form, for a time of up to one period of the slowest mode: every mode then has been in every phase.
"""

import numpy as np
from scipy.linalg import eigvalsh, expm

from flexsurr.beam.equilibrium import find_equilibrium, tangent_stiffness
from flexsurr.beam.initial_conditions import drawn_amplitudes, initial_states
from flexsurr.beam.kinematics import mass_matrix
from flexsurr.beam.projection import ModalBasis
from flexsurr.config.study import InitialConditions
from flexsurr.simulation.rhs import Array


def sample_configurations(
    basis: ModalBasis, settings: InitialConditions, first: int, count: int
) -> tuple[Array, Array]:
    """Coordinates η and rates η̇ (count, r) of linear motion; numbers `first` … `first + count − 1`.

    Initial states and times follow a Sobol sequence, of which one part fills the gaps of those before it.
    Raises EquilibriumNotFound where the structure buckles under its own weight.
    """
    from scipy.stats.qmc import Sobol  # here, for scipy.stats takes a second to import

    sequence = Sobol(2 * drawn_amplitudes(basis, settings) + 1, scramble=False)
    sequence.fast_forward(first + 1)  # its first point is a corner
    unit = sequence.random(count)
    states = initial_states(basis, settings, unit[:, :-1])
    r = basis.modes.shape[1]
    equilibrium = find_equilibrium(basis)
    at = basis.modes @ equilibrium
    mass, springs = (
        basis.modes.T @ matrix @ basis.modes
        for matrix in (mass_matrix(basis.structure, at), tangent_stiffness(basis.structure, at))
    )
    of_rates = -np.linalg.solve(mass, np.hstack([springs, basis.damping]))
    generator = np.block([[np.zeros((r, r)), np.eye(r)], [of_rates]])
    period_s = 2.0 * np.pi / np.sqrt(eigvalsh(springs, mass)[0])
    start = np.hstack([states[:, :r] - equilibrium, np.linalg.solve(mass, states[:, r:].T).T])
    times = period_s * unit[:, -1]
    moved = (expm(times[:, None, None] * generator) @ start[..., None])[..., 0]
    return moved[:, :r] + equilibrium, np.ascontiguousarray(moved[:, r:])
