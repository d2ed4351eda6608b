"""Samples without a simulation: states at sampled configurations, and the reduced model's matrices there."""

import hashlib
from dataclasses import dataclass

import numpy as np

from flexsurr.beam import ModalBasis, mirrors, reduced_order
from flexsurr.beam.linear_motion import sample_configurations
from flexsurr.config.study import InitialConditions, Variant
from flexsurr.simulation.rhs import Array
from flexsurr.surrogates.packed import packed_size, symmetric
from flexsurr.training.dataset import Dataset

VALIDATION = 0.2  # configurations to validate on, over those to train on


@dataclass(frozen=True, eq=False)
class ConfigurationSamples(Dataset):
    """A state (η, p = M η̇) at each configuration with its derivative, and what does not depend on p.

    `mass` (m, r, r) is M(η) at the training samples, `forces` (m, r) what acts there at rest, −∂V/∂η.
    `stiffness` (r, r) is K of the forces −K η at rest, the best one where gravity makes them another function
    of η; `damping` (r, r) is C. `mirrors` (k, r) are changes of sign of η under which M only changes signs.
    """

    mass: Array
    forces: Array
    stiffness: Array
    damping: Array
    mirrors: Array


def configuration_samples(
    basis: ModalBasis, variant: Variant, initial_conditions: InitialConditions, count: int
) -> ConfigurationSamples:
    """`count` configurations to train on, and a fifth as many more of the same sequence to validate on.

    They lie where linear motion from `initial_conditions` leads. Raises EquilibriumNotFound as that does.
    """
    total = count + max(round(VALIDATION * count), 2)
    eta, rates = sample_configurations(basis, initial_conditions, 0, total)
    model = reduced_order(basis, variant, "compiled")  # NumPy takes milliseconds for each of thousands
    mass = model.mass_matrix(eta)
    x = np.hstack([eta, np.einsum("sij,sj->si", mass, rates)])
    dx = np.array([model.derivative(0.0, state) for state in x])
    at_rest = np.hstack([eta, np.zeros_like(eta)])
    forces = np.array([model.derivative(0.0, state)[eta.shape[1] :] for state in at_rest])
    sha256 = hashlib.sha256(repr((model.state_names, model.state_units)).encode())
    for part in (x, dx):
        sha256.update(part.tobytes())
    return ConfigurationSamples(
        x_train=x[:count],
        dx_train=dx[:count],
        x_validation=x[count:],
        dx_validation=dx[count:],
        trajectory_train=np.arange(count),
        trajectory_validation=np.arange(count, total),
        state_names=model.state_names,
        state_units=model.state_units,
        sha256=sha256.hexdigest(),
        mass=mass[:count],
        forces=forces[:count],
        stiffness=_stiffness(eta, forces),
        damping=basis.damping,
        mirrors=mirrors(basis),
    )


def _stiffness(eta: Array, forces: Array) -> Array:
    """The symmetric K (r, r) with which −K η is nearest to `forces` (m, r) at `eta` (m, r)."""
    r = eta.shape[1]
    units = symmetric(np.eye(packed_size(r)), r)
    rows = np.einsum("eij,sj->sie", units, eta).reshape(-1, len(units))
    packed, *_ = np.linalg.lstsq(rows, -forces.ravel())
    return symmetric(packed, r)
