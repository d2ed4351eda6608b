"""The right-hand side, integrators, trajectories."""

from flexsurr.simulation.ensemble import Ensemble, simulate_ensemble
from flexsurr.simulation.jacobian import implements_jacobian, jacobian
from flexsurr.simulation.rhs import Array, CompiledModel, Model, evaluate, implements_rhs, rhs
from flexsurr.simulation.simulate import simulate
from flexsurr.simulation.trajectory import Trajectory

__all__ = [
    "Array",
    "CompiledModel",
    "Ensemble",
    "Model",
    "Trajectory",
    "evaluate",
    "implements_jacobian",
    "implements_rhs",
    "jacobian",
    "rhs",
    "simulate",
    "simulate_ensemble",
]
