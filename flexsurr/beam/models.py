"""The reference models: full order (eqs. 6, 7) and reduced order (eq. 10), three implementations each.

described   loops over elements and joints with complex steps: the equations as they read
numpy       vectorised, tangents in the directions of the coordinates only
compiled    kernels that compiled integrators step
"""

from typing import Literal, get_args

from flexsurr.beam.compiled import CompiledBeam
from flexsurr.beam.described import DescribedBeam
from flexsurr.beam.dynamics import BeamModel
from flexsurr.beam.planar import is_planar
from flexsurr.beam.projection import ModalBasis, Projection, projection
from flexsurr.beam.vectorised import VectorisedBeam, VectorisedPlanarBeam
from flexsurr.config.structure import Structure
from flexsurr.config.study import Variant

Implementation = Literal["described", "numpy", "compiled"]


def full_order(structure: Structure, variant: Variant, implementation: Implementation) -> BeamModel:
    """The model in all joint coordinates: states (q, p) of length 2n, eqs. 6 and 7.

    ValueError for an unknown variant or implementation.
    """
    return _model(projection(structure), variant, implementation)


def reduced_order(basis: ModalBasis, variant: Variant, implementation: Implementation) -> BeamModel:
    """The model in the modal coordinates of `basis`: states (η, p) of length 2r, q = Φ η, eq. 10.

    ValueError for an unknown variant or implementation.
    """
    return _model(projection(basis), variant, implementation)


def check_implementation(implementation: str) -> None:
    """ValueError unless `implementation` is one of the three."""
    _check("implementation", implementation, get_args(Implementation))


def _model(space: Projection, variant: Variant, implementation: Implementation) -> BeamModel:
    _check("variant", variant, get_args(Variant))
    check_implementation(implementation)
    if implementation == "described":
        return DescribedBeam(space, variant)
    if implementation == "compiled":
        return CompiledBeam(space, variant)
    planar = is_planar(space.structure)
    return VectorisedPlanarBeam(space, variant) if planar else VectorisedBeam(space, variant)


def _check(name: str, value: str, allowed: tuple[str, ...]) -> None:
    if value not in allowed:
        raise ValueError(f"{name}: {value!r} is not one of {', '.join(allowed)}")
