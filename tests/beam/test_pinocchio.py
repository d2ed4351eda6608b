"""The chain against Pinocchio's rigid-body algorithms: all four joints, lumped masses, springs aside.

A constant rotary inertia is taken off the mass matrix for the comparison: it is counted along the chain as a
constant matrix, which no set of rigid bodies reproduces. Being constant, it adds to no force. An exact one is
that of the bodies.
"""

import numpy as np
import pinocchio
import pytest
from structures import ALL_JOINTS, FORMS, change, coordinates

from flexsurr.beam import chain, full_order, mass_matrix, rotary_inertia, stiffness_matrix
from flexsurr.beam.rotation_vector import rotation

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
    "exact inertia": change(ALL_JOINTS, **FORMS[2], elements=ELEMENTS),
    "bent, with an engine": change(ALL_JOINTS, **FORMS[-2], elements=ELEMENTS),
}


def rigid_body_model(structure):
    model = pinocchio.Model()
    beam = chain(structure)
    turns = np.tile(np.eye(3), (ELEMENTS, 1, 1)) if beam.turns is None else beam.turns
    node = pinocchio.SE3(np.array(beam.clamp), np.zeros(3))
    parent = 0
    for i in range(ELEMENTS):
        placement = node * pinocchio.SE3(np.array(turns[i]), np.zeros(3))
        tensor = np.zeros((3, 3)) if beam.tensors is None else np.array(beam.tensors[i])
        body = pinocchio.Inertia(beam.masses[i], np.array(beam.arms[i]), tensor)
        joints = [
            pinocchio.JointModelRZ(),
            pinocchio.JointModelRevoluteUnaligned(np.array([0.0, -1.0, 0.0])),
            pinocchio.JointModelRX(),
        ]
        if beam.by_vector:
            joints = [pinocchio.JointModelSpherical()]
        joints.append(pinocchio.JointModelPrismaticUnaligned(np.array(beam.stretches[i])))
        for kind, joint in enumerate(joints):
            parent = model.addJoint(parent, joint, placement, f"{kind}_{i}")
            placement = pinocchio.SE3.Identity()
        model.appendBodyToJoint(parent, body, pinocchio.SE3.Identity())
        node = pinocchio.SE3(np.eye(3), np.array(beam.spans[i]))
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


@pytest.mark.parametrize("seed", range(3))
def test_mass_matrix_of_rotation_vectors(seed):
    """Of ball joints, whose rates are angular velocities: u̇ makes them by its tangent, columns of T."""
    structure = change(ALL_JOINTS, **FORMS[-1], elements=ELEMENTS)
    q = coordinates(structure, seed)
    psi, theta, phi, stretch = q.reshape(4, ELEMENTS)
    turns, tangents = rotation(np.stack([phi, -theta, psi], axis=-1))
    at, of_rates = [], np.zeros((4 * ELEMENTS, 4 * ELEMENTS))
    for i in range(ELEMENTS):
        at += [*pinocchio.Quaternion(turns[i]).coeffs(), stretch[i]]
        of_rates[4 * i : 4 * i + 3, i::ELEMENTS][:, :3] = tangents[i] @ [[0, 0, 1], [0, -1, 0], [1, 0, 0]]
        of_rates[4 * i + 3, 3 * ELEMENTS + i] = 1.0
    model = rigid_body_model(structure)
    mass = pinocchio.crba(model, model.createData(), np.array(at))
    mass = of_rates.T @ (np.triu(mass) + np.triu(mass, 1).T) @ of_rates
    np.testing.assert_allclose(mass_matrix(structure, q), mass, atol=1e-12 * np.abs(mass).max())
