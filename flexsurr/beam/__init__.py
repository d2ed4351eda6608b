"""The lumped-mass multibody beam: full-order and reduced-order models, loads, equilibria, modes."""

from flexsurr.beam.chain import Chain, chain, damping_matrix, rotary_inertia, stiffness_matrix
from flexsurr.beam.dynamics import BeamModel
from flexsurr.beam.elastica import elastica_tip
from flexsurr.beam.equilibrium import EquilibriumNotFound, find_equilibrium
from flexsurr.beam.initial_conditions import draw_initial_conditions
from flexsurr.beam.kinematics import element_frames, mass_matrix, node_positions, tip_position, tip_twist
from flexsurr.beam.loaded import LoadedModel, loaded
from flexsurr.beam.loads import Load, load_forces
from flexsurr.beam.mirrors import mirrors
from flexsurr.beam.models import Implementation, full_order, reduced_order
from flexsurr.beam.modes import natural_modes, reduce
from flexsurr.beam.projection import ModalBasis

__all__ = [
    "BeamModel",
    "Chain",
    "EquilibriumNotFound",
    "Implementation",
    "Load",
    "LoadedModel",
    "ModalBasis",
    "chain",
    "damping_matrix",
    "draw_initial_conditions",
    "elastica_tip",
    "element_frames",
    "find_equilibrium",
    "full_order",
    "load_forces",
    "loaded",
    "mass_matrix",
    "mirrors",
    "natural_modes",
    "node_positions",
    "reduce",
    "reduced_order",
    "rotary_inertia",
    "stiffness_matrix",
    "tip_position",
    "tip_twist",
]
