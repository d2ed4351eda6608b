"""The right-hand side, integrators, trajectories."""

from flexsurr.simulation.jacobian import implements_jacobian, jacobian
from flexsurr.simulation.rhs import Array, CompiledModel, Model, evaluate, implements_rhs, rhs
from flexsurr.simulation.simulate import simulate
from flexsurr.simulation.trajectory import Trajectory

__all__ = [
    "Array",
    "CompiledModel",
    "Model",
    "Trajectory",
    "evaluate",
    "implements_jacobian",
    "implements_rhs",
    "jacobian",
    "rhs",
    "simulate",
]
