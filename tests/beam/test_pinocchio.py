"""The chain against Pinocchio's rigid-body algorithms: all four joints, lumped masses, springs aside.

The rotary inertia is taken off the mass matrix for the comparison: it is counted along the chain as a
constant matrix, which no set of rigid bodies reproduces. Being constant, it adds to no force.
"""

import numpy as np
import pinocchio
import pytest
from structures import ALL_JOINTS, change

from flexsurr.beam import chain, full_order, mass_matrix, rotary_inertia, stiffness_matrix

ELEMENTS = 5
STRUCTURES = {
    "all joints": change(ALL_JOINTS, elements=ELEMENTS),
    # the study's wing, whose masses lie a quarter of the chord off the elastic axis
    "wing": change(
        ALL_JOINTS,
        elements=ELEMENTS,
        length_m=16.0,
        mass_per_length_kg_m=0.75,
        chord_m=1.0,
        centre_of_gravity_offset_m=0.267,
        torsional_inertia_per_length_kg_m=0.1,
    ),
}


def rigid_body_model(structure):
    model = pinocchio.Model()
    beam = chain(structure)
    length = beam.element_length
    placement = pinocchio.SE3(np.array(beam.clamp), np.zeros(3))
    body = pinocchio.Inertia(beam.element_mass, np.array([length / 2, beam.offset, 0.0]), np.zeros((3, 3)))
    parent = 0
    for i in range(ELEMENTS):
        joints = [
            pinocchio.JointModelRZ(),
            pinocchio.JointModelRevoluteUnaligned(np.array([0.0, -1.0, 0.0])),
            pinocchio.JointModelRX(),
            pinocchio.JointModelPX(),
        ]
        for kind, joint in enumerate(joints):
            parent = model.addJoint(parent, joint, placement, f"{kind}_{i}")
            placement = pinocchio.SE3.Identity()
        model.appendBodyToJoint(parent, body, pinocchio.SE3.Identity())
        placement = pinocchio.SE3(np.eye(3), np.array([length, 0.0, 0.0]))
    model.gravity.linear = np.array(beam.gravity)
    return model


# Pinocchio counts element by element, q joint kind by joint kind.
ORDER = np.arange(4 * ELEMENTS).reshape(4, ELEMENTS).T.ravel()


@pytest.mark.parametrize("name", STRUCTURES)
@pytest.mark.parametrize("seed", range(10))
def test_mass_matrix_and_all_forces(name, seed):
    structure = STRUCTURES[name]
    random = np.random.default_rng(seed)
    q, rates = random.uniform(-1.0, 1.0, (2, 4 * ELEMENTS))
    q[3 * ELEMENTS :] *= 0.1
    model = rigid_body_model(structure)
    data = model.createData()
    mass = pinocchio.crba(model, data, q[ORDER])
    mass = np.triu(mass) + np.triu(mass, 1).T
    ours = mass_matrix(structure, q)
    lumped = ours - rotary_inertia(structure)
    np.testing.assert_allclose(lumped[np.ix_(ORDER, ORDER)], mass, atol=1e-12 * np.abs(mass).max())

    # With dM/dt = C + Cᵀ the gyroscopic term dM/dt q̇ − C q̇ is Cᵀ q̇.
    coriolis = np.array(pinocchio.computeCoriolisMatrix(model, data, q[ORDER], rates[ORDER]))
    gyroscopic = coriolis.T @ rates[ORDER]
    weight = -np.array(pinocchio.computeGeneralizedGravity(model, data, q[ORDER]))
    springs = -(stiffness_matrix(structure) @ q)[ORDER]
    x = np.concatenate([q, ours @ rates])
    for implementation in ("described", "numpy", "compiled"):
        kept, dropped = (
            full_order(structure, variant, implementation).derivative(0.0, x)
            for variant in ("hamiltonian", "as_printed")
        )
        np.testing.assert_allclose(kept[: len(q)], rates, atol=1e-9)
        forces = (kept - dropped)[len(q) :][ORDER]
        scale = np.abs(gyroscopic).max()
        np.testing.assert_allclose(forces, gyroscopic, rtol=0.0, atol=1e-9 * scale)
        np.testing.assert_allclose(dropped[len(q) :][ORDER], weight + springs, rtol=0.0, atol=1e-9 * scale)
