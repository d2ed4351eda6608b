"""Loads without kinematics: generalised forces from learned positions.

The study computes generalised forces analytically, from the kinematics of the model that the surrogate
stands for. Here the points where forces act are learned as functions of η, and virtual work gives

    Q̂ = Σ (∂r̂_i/∂η)ᵀ f_i

For a load of fixed shape f the map η → Q̂ is then fitted by itself: once as a polynomial, once as a network,
both far smaller than the kinematics. Loads along several axes that follow one history are one such shape.
"""

from dataclasses import dataclass

import numpy as np
import pandas as pd

from flexsurr.beam import ModalBasis, chain, load_forces, tip_position, tip_twist
from flexsurr.beam.kinematics import configuration, generalised_forces, tip_up
from flexsurr.beam.loads import Forces
from flexsurr.config.structure import Structure
from flexsurr.config.study import EvaluationSettings, Variant
from flexsurr.simulation.rhs import Array
from flexsurr.surrogates import LearnedMap, NetworkMap, PolynomialMap, generalised_force
from flexsurr.training import fit_network_map, fit_polynomial_map
from flexsurr.training.map_fitting import coordinates

AXES = "xyz"
_ROUNDING = 1e-12  # generalised forces of less, beside what the load could do at most, are none
AS_GOOD = 2.0  # even powers alone are kept if they err at most so much more


@dataclass(frozen=True, eq=False)
class LearnedKinematics:
    """The map η → centres (N, 3) and tip (3,) [m], and two numbers whose angle is the tip's twist.

    In the clamp's frame before it is turned. The numbers are the components along the clamp's z of the last
    element's y and z: the twist itself jumps, they do not.
    """

    structure: Structure
    outputs: LearnedMap

    def tip(self, eta: Array) -> Array:
        """(k, 3) position of the tip [m] at η (k, r)."""
        return self.outputs(eta)[:, -5:-2]

    def twist(self, eta: Array) -> Array:
        """(k,) twist of the tip against the clamp [rad] at η (k, r), as `tip_twist` defines it."""
        up = self.outputs(eta)[:, -2:]
        return np.asarray(np.arctan2(up[:, 0], up[:, 1]))

    def generalised_force(self, eta: Array, load: Forces) -> Array:
        """Q̂ (k, r) at η (k, r), at a factor of 1."""
        forces = np.concatenate([load.on_centres.ravel(), load.on_tip, np.zeros(2)])
        return generalised_force(self.outputs, eta, forces)


def learn_kinematics(basis: ModalBasis, eta: Array, degree: int) -> LearnedKinematics:
    """Polynomials of total degree ≤ `degree` for everything, from what is seen at η (k, r)."""
    structure = basis.structure
    at = configuration(chain(structure), eta @ basis.modes.T)
    up = tip_up(chain(structure), at)
    seen = np.hstack([at.centres.reshape(len(eta), -1), at.nodes[:, -1], up[:, 1:]])
    points = [*(f"centre_{i}" for i in range(1, structure.elements + 1)), "tip"]
    names = (*(f"{point}_{axis}" for point in points for axis in AXES), "tip_y_up", "tip_z_up")
    return LearnedKinematics(structure, fit_polynomial_map(coordinates(eta), eta, seen, names, degree))


@dataclass(frozen=True, eq=False)
class LearnedForces:
    """The generalised forces Q̂(η) of one load: by way of the kinematics, and fitted by themselves twice."""

    kinematics: LearnedKinematics
    load: Forces
    polynomial: PolynomialMap
    network: NetworkMap


def learn_forces(
    basis: ModalBasis, evaluation: EvaluationSettings, eta: Array, held_out: Array
) -> LearnedForces:
    """The forced response's load, learned at `eta` (k, r); even powers alone where `held_out` (l, r) allows.

    Raises ValueError where a coordinate does not vary over the samples, or where the load moves no mode.
    """
    settings = evaluation.learned_load
    load = load_forces(basis.structure, evaluation.load)
    kinematics = learn_kinematics(basis, eta, settings.kinematics_degree)
    size = np.linalg.norm(load.on_centres) + np.linalg.norm(load.on_tip)
    reach = size * basis.structure.length_m * np.linalg.norm(basis.modes, 2)
    if not np.max(np.abs(exact_forces(basis, load, held_out))) > _ROUNDING * reach:
        raise ValueError(f"{basis.structure.name}: the load moves none of the {basis.modes.shape[1]} mode(s)")
    forces, expected = (kinematics.generalised_force(at, load) for at in (eta, held_out))
    names = tuple(f"Q{k + 1}" for k in range(eta.shape[1]))
    inputs = coordinates(eta)
    even, whole = (
        fit_polynomial_map(inputs, eta, forces, names, settings.degree, only) for only in (True, False)
    )
    errors = [relative_error(fitted(held_out), expected) for fitted in (even, whole)]
    network = fit_network_map(
        inputs, eta, forces, names, settings.hidden, settings.activation, settings.epochs
    )
    return LearnedForces(kinematics, load, even if errors[0] <= AS_GOOD * errors[1] else whole, network)


def learned_load_table(
    study_name: str, basis: ModalBasis, variant: Variant, learned: LearnedForces, eta: Array
) -> pd.DataFrame:
    """The rows of learned_loads.csv: what each map errs by at held-out η (k, r).

    Of the kinematics, tip_rms_over_length: root mean square of the tip's distance from its place, and
    twist_largest_error_rad. Of all, force_relative_error: ‖Q̂ − Q‖ / ‖Q‖ over the samples, Q being exact.
    """
    structure, kinematics = basis.structure, learned.kinematics
    q = eta @ basis.modes.T
    off = np.linalg.norm(kinematics.tip(eta) - tip_position(structure, q), axis=1)
    turn = kinematics.twist(eta) - tip_twist(structure, q)
    seen = {
        "tip_rms_over_length": float(np.sqrt(np.mean(off**2))) / structure.length_m,
        # the angle jumps at ±π, its error does not
        "twist_largest_error_rad": float(np.max(np.abs(np.angle(np.exp(1j * turn))))),
    }
    maps = {
        "kinematics": (kinematics.outputs, kinematics.generalised_force(eta, learned.load), seen),
        "polynomial": (learned.polynomial, learned.polynomial(eta), {}),
        "network": (learned.network, learned.network(eta), {}),
    }
    exact = exact_forces(basis, learned.load, eta)
    rows = [
        {
            "study": study_name,
            "variant": variant,
            "map": name,
            "form": fitted.form,
            "parameters": fitted.parameter_count,
            "force_relative_error": relative_error(forces, exact),
            **more,
        }
        for name, (fitted, forces, more) in maps.items()
    ]
    return pd.DataFrame(rows)


def exact_forces(basis: ModalBasis, load: Forces, eta: Array) -> Array:
    """Q (k, r) at η (k, r) from the kinematics, at a factor of 1."""
    beam = chain(basis.structure)
    at = configuration(beam, eta @ basis.modes.T)
    return generalised_forces(beam, at, np.zeros_like(load.on_centres), *load) @ basis.modes


def relative_error(found: Array, expected: Array) -> float:
    """‖found − expected‖ / ‖expected‖ over all samples and coordinates."""
    return float(np.linalg.norm(found - expected) / np.linalg.norm(expected))
