"""Loads without kinematics: generalised forces from learned positions.

The study computes generalised forces analytically, from the kinematics of the model that the surrogate
stands for. Here the points where forces act are learned as functions of η, and virtual work gives

    Q̂ = Σ (∂r̂_i/∂η)ᵀ f_i

For a load of fixed shape f the map η → Q̂ is then fitted by itself: once as a polynomial, once as a network,
both far smaller than the kinematics. Loads along several axes that follow one history are one such shape; of
loads with several histories the maps hold the forces of each. Positions do not tell what a moment does, or a
load that follows: the maps of such loads are fitted to the exact forces.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd

from flexsurr.beam import ModalBasis, chain, tip_position, tip_twist
from flexsurr.beam.kinematics import configuration, tip_up
from flexsurr.beam.loads import Forces, Part, acting, load_parts
from flexsurr.config.load import turns_clamp
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
        """Q̂ (k, r) at η (k, r) of dead forces on centres and tip."""
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
    """The generalised forces Q̂(η) of a load: by way of the kinematics, and fitted by themselves twice."""

    kinematics: LearnedKinematics
    load: tuple[Part, ...]
    polynomial: PolynomialMap
    network: NetworkMap


def learn_forces(
    basis: ModalBasis, evaluation: EvaluationSettings, eta: Array, held_out: Array
) -> LearnedForces:
    """The forced response's load, learned at `eta` (k, r); even powers alone where `held_out` (l, r) allows.

    Raises ValueError where a coordinate does not vary over the samples, where the load moves no mode, and
    where the clamp turns.
    """
    settings = evaluation.learned_load
    if turns_clamp(evaluation.load):
        raise ValueError("load: what a turning clamp exerts depends on rates; allowed: a load that does not")
    parts = load_parts(basis.structure, evaluation.load)
    kinematics = learn_kinematics(basis, eta, settings.kinematics_degree)
    if not np.max(np.abs(exact_forces(basis, parts, held_out))) > _ROUNDING * _reach(basis, parts):
        raise ValueError(f"{basis.structure.name}: the load moves none of the {basis.modes.shape[1]} mode(s)")
    forces, expected = (_targets(basis, kinematics, parts, at) for at in (eta, held_out))
    loads = [f"_of_load_{k + 1}" for k in range(len(parts))] if len(parts) > 1 else [""]
    names = tuple(f"Q{k + 1}{of_load}" for of_load in loads for k in range(eta.shape[1]))
    inputs = coordinates(eta)
    even, whole = (
        fit_polynomial_map(inputs, eta, forces, names, settings.degree, only) for only in (True, False)
    )
    errors = [relative_error(fitted(held_out), expected) for fitted in (even, whole)]
    network = fit_network_map(
        inputs, eta, forces, names, settings.hidden, settings.activation, settings.epochs
    )
    return LearnedForces(kinematics, parts, even if errors[0] <= AS_GOOD * errors[1] else whole, network)


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
    maps: dict[str, tuple[LearnedMap, Array, dict[str, float]]] = {}
    if tell_positions(learned.load):
        through = _targets(basis, kinematics, learned.load, eta)
        maps["kinematics"] = (kinematics.outputs, through, seen)
    # the same columns where no map tells positions, as of a load that follows
    unseen = dict.fromkeys(seen, float("nan"))
    maps["polynomial"] = (learned.polynomial, learned.polynomial(eta), unseen)
    maps["network"] = (learned.network, learned.network(eta), unseen)
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


def exact_forces(basis: ModalBasis, parts: Sequence[Part], eta: Array) -> Array:
    """Q (k, parts r) at η (k, r) from the kinematics, at factors of 1, part after part of the load."""
    beam = chain(basis.structure)
    at = configuration(beam, eta @ basis.modes.T)
    alone = [acting(beam.elements, [part], [1.0]) for part in parts]
    return np.hstack([now.generalised(beam, at) @ basis.modes for now in alone])


def tell_positions(parts: Sequence[Part]) -> bool:
    """Whether positions of centres and tip tell all that it does: dead forces on the elastic axis."""
    return not any(part.follows or part.forces.on_masses.any() or part.forces.couples.any() for part in parts)


def _targets(basis: ModalBasis, kinematics: LearnedKinematics, parts: Sequence[Part], eta: Array) -> Array:
    """Q (k, parts r) at η (k, r) that maps are fitted to."""
    if not tell_positions(parts):
        return exact_forces(basis, parts, eta)
    return np.hstack([kinematics.generalised_force(eta, part.forces) for part in parts])


def _reach(basis: ModalBasis, parts: Sequence[Part]) -> float:
    """A bound of the generalised forces of any part, at a factor of 1."""
    sizes = []
    for forces in (part.forces for part in parts):
        pushes = sum(np.linalg.norm(push) for push in (forces.on_centres, forces.on_tip, forces.on_masses))
        sizes.append(pushes * basis.structure.length_m + np.linalg.norm(forces.couples))
    return float(max(sizes) * np.linalg.norm(basis.modes, 2))


def relative_error(found: Array, expected: Array) -> float:
    """‖found − expected‖ / ‖expected‖ over all samples and coordinates."""
    return float(np.linalg.norm(found - expected) / np.linalg.norm(expected))
