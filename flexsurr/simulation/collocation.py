"""Coefficients of collocation methods, worked out from their nodes."""

import numpy as np

from flexsurr.simulation.rhs import Array


def lagrange(nodes: Array, at: Array) -> Array:
    """Values (m, s) at `at` (m,) of the polynomials that are 1 at one of `nodes` (s,) and 0 at the others."""
    weights = np.linalg.inv(np.vander(nodes, increasing=True))
    return np.vander(at, nodes.size, increasing=True) @ weights


def collocation_matrix(nodes: Array, to: Array) -> Array:
    """Integrals (m, s) of the same polynomials from 0 to each of `to` (m,); those to the nodes are A."""
    weights = np.linalg.inv(np.vander(nodes, increasing=True))
    powers = np.arange(1, nodes.size + 1)
    return to[:, None] ** powers / powers @ weights
