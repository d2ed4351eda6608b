import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from structures import (
    ALL_JOINTS,
    CANTILEVER,
    FORMS,
    SEEDS,
    any_structures,
    basis_of,
    change,
    state,
    structures,
)

from flexsurr.beam import full_order, reduced_order
from flexsurr.beam.compiled import planar_kernel, planar_mode_kernel, rigid_kernel, spatial_kernel
from flexsurr.beam.planar_sweep import PlanarChain, planar_work_size
from flexsurr.beam.projection import projection
from flexsurr.beam.rigid_sweep import RigidChain, rigid_work_size
from flexsurr.beam.spatial_sweep import SpatialChain, spatial_work_size
from flexsurr.beam.vectorised import VectorisedBeam
from flexsurr.simulation import CompiledModel, Model, evaluate

VARIANTS = st.sampled_from(["hamiltonian", "as_printed"])


def assert_close(found, expected):
    half = len(expected) // 2
    for part in (slice(0, half), slice(half, None)):
        scale = np.abs(expected[part]).max()
        np.testing.assert_allclose(found[part], expected[part], rtol=0.0, atol=1e-10 * scale)


@settings(max_examples=60)
@given(any_structures(), VARIANTS, SEEDS)
def test_full_order_implementations_agree(structure, variant, seed):
    described, vectorised, compiled = (
        full_order(structure, variant, kind) for kind in ("described", "numpy", "compiled")
    )
    x = state(structure, seed)
    expected = described.derivative(0.0, x)
    assert_close(vectorised.derivative(0.0, x), expected)
    assert_close(compiled.derivative(0.0, x), expected)


@settings(max_examples=60)
@given(any_structures(), VARIANTS, st.integers(1, 4), st.sampled_from(["unit", "mass"]), SEEDS)
def test_reduced_order_implementations_agree(structure, variant, modes, normalisation, seed):
    basis = basis_of(structure, modes, normalisation)
    described, vectorised, compiled = (
        reduced_order(basis, variant, kind) for kind in ("described", "numpy", "compiled")
    )
    x = state(basis, seed)
    expected = described.derivative(0.0, x)
    assert_close(vectorised.derivative(0.0, x), expected)
    assert_close(compiled.derivative(0.0, x), expected)


@settings(max_examples=12)
@given(any_structures(), st.integers(1, 4), SEEDS)
def test_tips_and_energies_agree(structure, modes, seed):
    basis = basis_of(structure, modes, "mass")
    vectorised, compiled = (reduced_order(basis, "hamiltonian", kind) for kind in ("numpy", "compiled"))
    x = np.array([[state(basis, seed + k) for k in range(3)]])
    np.testing.assert_allclose(
        compiled.tip(x), vectorised.tip(x), rtol=1e-11, atol=1e-11 * structure.length_m
    )
    expected = vectorised.energy(x)
    np.testing.assert_allclose(compiled.energy(x), expected, rtol=1e-10, atol=1e-10 * np.abs(expected).max())


@settings(max_examples=30)
@given(structures(centre_of_gravity_offset_m=0.0), st.sampled_from(["in_plane", "out_of_plane"]), SEEDS)
def test_planar_kernels_are_the_general_one(structure, joint, seed):
    basis = basis_of(change(structure, joints=(joint,)), 1)
    space = projection(basis)
    x = state(basis, seed)
    general = derivative(spatial_kernel(space, True), x, spatial_work_size(structure.elements, 1))
    planar = derivative(planar_kernel(space, True), x, planar_work_size(structure.elements, 1))
    mode = derivative(planar_mode_kernel(space, True), x, planar_work_size(structure.elements, 1))
    assert_close(planar, general)
    assert_close(mode, general)
    assert_close(VectorisedBeam(space, "hamiltonian").derivative(0.0, x), general)


@settings(max_examples=30)
@given(structures(), SEEDS)
def test_the_kernel_of_uniform_chains_is_the_one_of_any(structure, seed):
    space = projection(structure)
    x = state(structure, seed)
    uniform = derivative(spatial_kernel(space, True), x, spatial_work_size(structure.elements, len(x) // 2))
    any_chain = derivative(rigid_kernel(space, True), x, rigid_work_size(structure.elements, len(x) // 2))
    assert_close(uniform, any_chain)


@settings(max_examples=30)
@given(any_structures(), st.sampled_from(["in_plane", "out_of_plane"]), SEEDS)
def test_planar_kernels_are_the_one_of_any_chain(structure, joint, seed):
    """Where properties vary, too; a chain that leaves its plane has the general kernel."""
    basis = basis_of(change(structure, joints=(joint,)), 1)
    space = projection(basis)
    x = state(basis, seed)
    general = derivative(rigid_kernel(space, True), x, rigid_work_size(structure.elements, 1))
    model = reduced_order(basis, "hamiltonian", "compiled")
    assert_close(derivative(model.kernel, x, model.work_size), general)


def test_each_chain_has_the_least_kernel_that_holds_it():
    kinds = [type(full_order(change(ALL_JOINTS, **form), "hamiltonian", "compiled").kernel) for form in FORMS]
    assert kinds == [SpatialChain] + [RigidChain] * (len(FORMS) - 1)
    tapered = change(ALL_JOINTS, **FORMS[5], joints=("out_of_plane",))
    assert isinstance(full_order(tapered, "hamiltonian", "compiled").kernel, PlanarChain)


def derivative(kernel, x, work_size):
    dx = np.full_like(x, np.nan)
    work = np.full(work_size + 1, np.nan)
    work[-1] = 7.0
    evaluate(kernel, 0.0, x, dx, work[:-1])
    assert work[-1] == 7.0
    return dx


@pytest.mark.parametrize("elements", [1, 2, 3, 4, 5, 7, 8, 10, 17])
@pytest.mark.parametrize("joints", [("out_of_plane",), ("in_plane", "torsion")])
def test_kernels_stay_within_their_scratch(elements, joints):
    structure = change(
        CANTILEVER,
        elements=elements,
        joints=joints,
        gravity_m_s2=9.81,
        bending_stiffness_in_plane_N_m2=1.0,
        torsional_stiffness_N_m2=1.0,
        torsional_inertia_per_length_kg_m=0.1,
    )
    basis = basis_of(structure, 1)
    for system, model in (
        (structure, full_order(structure, "hamiltonian", "compiled")),
        (basis, reduced_order(basis, "hamiltonian", "compiled")),
    ):
        x = state(system, elements)
        np.testing.assert_allclose(derivative(model.kernel, x, model.work_size), model.derivative(0.0, x))


def test_dropping_the_gyroscopic_term_changes_the_momenta_only():
    basis = basis_of(CANTILEVER, 1, "unit")
    x = np.array([0.3, 1.5])
    kept = reduced_order(basis, "hamiltonian", "compiled").derivative(0.0, x)
    dropped = reduced_order(basis, "as_printed", "compiled").derivative(0.0, x)
    assert kept[0] == dropped[0]
    assert abs(kept[1] - dropped[1]) > 1e-3 * abs(kept[1])


def test_models_name_their_states_and_follow_the_protocol():
    model = reduced_order(basis_of(CANTILEVER, 2, "unit"), "hamiltonian", "compiled")
    assert isinstance(model, CompiledModel)
    assert model.state_names == ("eta_1", "eta_2", "p_1", "p_2")
    assert model.state_units == ("rad", "rad", "kg m²/s", "kg m²/s")
    full = full_order(change(CANTILEVER, elements=2), "as_printed", "described")
    assert isinstance(full, Model)
    assert not isinstance(full, CompiledModel)
    joints = ("out_of_plane_1", "out_of_plane_2")
    assert full.state_names == (*(f"q_{name}" for name in joints), *(f"p_{name}" for name in joints))


@pytest.mark.parametrize(
    ("variant", "implementation", "message"),
    [("printed", "numpy", "variant: 'printed' is not one of"), ("as_printed", "jax", "'jax' is not one of")],
)
def test_unknown_names_are_refused(variant, implementation, message):
    with pytest.raises(ValueError, match=message):
        full_order(CANTILEVER, variant, implementation)
