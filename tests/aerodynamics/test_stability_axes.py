"""Lift, drag and the rest against forces summed by hand, and the way back to body axes."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from wings import MIDDLES, RANGES, flexible_airliner, in_body_axes, symmetric_and_antisymmetric

from flexsurr.aerodynamics.features import (
    ALPHA,
    ALTITUDE,
    BETA,
    COEFFICIENTS,
    CONTROLS,
    FIRST_CONTROL,
    FIRST_ETA,
    FIRST_ETA_RATE,
    MACH,
    MODES,
    RATE_P,
)
from flexsurr.aerodynamics.forces import name_coefficients, parasite_drag, reflected
from flexsurr.aerodynamics.horseshoe import influence
from flexsurr.aerodynamics.mach_grid import fixed_machs
from flexsurr.aerodynamics.quadratic import quadratic
from flexsurr.aerodynamics.vortex_lattice import frozen, rebuilt

AIRFRAME = flexible_airliner(symmetric_and_antisymmetric)
FORM = rebuilt(AIRFRAME)


def turned(axis, angle, vectors):
    """Vectors (n, 3) turned about unit axes (n, 3), by Rodrigues' formula; zero axes leave them."""
    along = np.sum(axis * vectors, axis=1)[:, None] * axis
    sine, cosine = np.sin(angle), np.cos(angle)
    held = np.linalg.norm(axis, axis=1)[:, None] == 0.0
    moved = cosine * vectors + sine * np.cross(axis, vectors) + (1.0 - cosine) * along
    return np.where(held, vectors, moved)


def forces_by_hand(u):
    """Forces (N, 3) over q̄ S on the bound vortices in geometry axes, their points, and all the rest."""
    lattice, motion = AIRFRAME.lattice, AIRFRAME.motion
    origin = np.array(AIRFRAME.centre_of_gravity)
    eta, rate = u[FIRST_ETA : FIRST_ETA + MODES], u[FIRST_ETA_RATE : FIRST_ETA_RATE + MODES]
    normal = lattice.normal
    for k in range(CONTROLS):
        normal = turned(lattice.hinge[:, k], u[FIRST_CONTROL + k], normal)
    normal = normal + np.cross(motion.rotation @ eta, normal)
    alpha, beta = u[ALPHA], u[BETA]
    onset = np.array([np.cos(alpha) * np.cos(beta), -np.sin(beta), np.sin(alpha) * np.cos(beta)])
    turning = u[RATE_P : RATE_P + 3] * [-1.0, 1.0, -1.0]

    def against(points, shift):
        return onset - np.cross(turning, points - origin) - shift @ rate

    panels = FORM.kernel.panels
    stretch = 1.0 / np.sqrt(1.0 - u[MACH] ** 2)
    at_control = influence(panels.ends, stretch, panels.control)
    at_bound = influence(panels.ends, stretch, panels.bound)
    wash = np.sum(against(lattice.control, motion.translation) * normal, axis=1)
    gamma = np.linalg.solve(np.einsum("dij,id->ij", at_control, lattice.normal), -wash)
    velocity = against(lattice.bound, motion.bound_translation) + np.einsum("dij,j->id", at_bound, gamma)
    force = 2.0 * gamma[:, None] * np.cross(velocity, lattice.end - lattice.start) / AIRFRAME.reference.area
    return force, lattice.bound - origin, onset


@settings(max_examples=10)
@given(seed=st.integers(0, 2**20))
def test_coefficients_are_the_sums_of_forces_along_their_directions(seed):
    u = MIDDLES + RANGES * np.random.default_rng(seed).uniform(-1.0, 1.0, 25)
    force, arm, onset = forces_by_hand(u)
    reference = AIRFRAME.reference
    drag = parasite_drag(AIRFRAME.parasite_drag_coefficient, u[MACH], u[ALTITUDE], reference.chord)
    total = force.sum(axis=0) + drag * onset
    moment = np.cross(arm, force).sum(axis=0)
    munk = 2.0 * AIRFRAME.munk_volume / reference.area * onset[0]
    # in geometry axes (x aft, y right, z up): the air comes from ahead and, for α > 0, from below
    downwind = np.array([np.cos(u[ALPHA]), 0.0, np.sin(u[ALPHA])])
    upwards = np.array([-np.sin(u[ALPHA]), 0.0, np.cos(u[ALPHA])])
    expected = {
        "C_L": total @ upwards,
        "C_D": total @ downwind,
        "C_Y": total[1],
        "C_m": (moment[1] + munk * onset[2]) / reference.chord,
        "C_l": -moment[0] / reference.span,
        "C_n": (-moment[2] + munk * onset[1]) / reference.span,
    }
    generalised = np.einsum("id,idk->k", force, AIRFRAME.motion.bound_translation)
    expected |= {f"C_phi_{k + 1}": generalised[k] for k in range(MODES)}
    assert dict(zip(COEFFICIENTS, FORM(u), strict=True)) == pytest.approx(expected, rel=1e-9, abs=1e-11)


@settings(max_examples=50)
@given(alpha=st.floats(-0.5, 0.5), seed=st.integers(0, 2**20))
def test_there_and_back_is_where_it_was(alpha, seed):
    sums = np.random.default_rng(seed).normal(size=12)
    u, y = np.zeros(25), sums.copy()
    u[ALPHA] = alpha
    name_coefficients(u, y)
    np.testing.assert_allclose(in_body_axes(u, y), sums, rtol=0.0, atol=1e-14)
    x, z = reflected(np.sin(alpha), np.cos(alpha), y[0], y[1])
    np.testing.assert_allclose([x, z], sums[[0, 2]], rtol=0.0, atol=1e-14)


def test_in_body_axes_the_lattice_with_a_linear_boundary_condition_is_quadratic():
    """A second difference that a quadratic function has everywhere, lift and drag have not."""
    grid = fixed_machs([0.5])
    rng = np.random.default_rng(0)
    step, start = RANGES * rng.uniform(-1.0, 1.0, 25), MIDDLES + RANGES * rng.uniform(-1.0, 1.0, 25)
    step[[MACH, ALTITUDE]] = 0.0
    for form in (frozen(AIRFRAME, grid, "linear"), quadratic(AIRFRAME, grid)):
        points = start + np.arange(4)[:, None] * step
        named = form(points)
        body = np.array([in_body_axes(u, c) for u, c in zip(points, named, strict=True)])
        third = np.diff(body, n=3, axis=0)
        np.testing.assert_allclose(third, 0.0, atol=1e-12)
        assert np.abs(np.diff(named, n=3, axis=0)[0, :2]).min() > 1e-6
