"""The frozen lattice in halves is the whole one, whatever flies; and only what is symmetric is halved."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from wings import (
    AIRLINER,
    FEW,
    MIDDLES,
    RANGES,
    flexible_airliner,
    symmetric_and_antisymmetric,
    wing,
)

from flexsurr.aerodynamics.airframe import Airframe, ModalMotion
from flexsurr.aerodynamics.features import (
    BETA,
    FEATURES,
    FIRST_CONTROL,
    FIRST_ETA,
    FIRST_ETA_RATE,
    RATE_P,
    RATE_R,
    ROLL,
    ReferenceDimensions,
)
from flexsurr.aerodynamics.halves import FrozenHalves, halves_of
from flexsurr.aerodynamics.lattice import (
    AILERON_LEFT,
    ELEVATOR_RIGHT,
    MIRROR,
    RUDDER,
    Lattice,
    airliner_lattice,
    panel,
)
from flexsurr.aerodynamics.mach_grid import fixed_machs, mach_grid
from flexsurr.aerodynamics.vortex_lattice import Frozen, frozen, frozen_whole, rebuilt
from flexsurr.config.aircraft import Section

GRID = mach_grid(0.3, 0.8, nodes=4, points=3)
UNITS = arrays(np.float64, len(FEATURES), elements=st.floats(-1.0, 1.0))
LATTICE = airliner_lattice(AIRLINER, FEW)
REFERENCE = ReferenceDimensions(1.0, 1.0, 1.0)


def of_no_symmetry(points):
    """Six modes that are neither symmetric nor antisymmetric."""
    translation, rotation = symmetric_and_antisymmetric(points + np.array([0.0, 3.0, 0.0]))
    return translation, rotation


def shuffled(airframe: Airframe, order) -> Airframe:
    lattice, motion = airframe.lattice, airframe.motion
    names = ("start", "end", "control", "normal", "hinge", "corners", "surface")
    moved = replace(lattice, **{name: getattr(lattice, name)[order] for name in names})
    modes = ModalMotion(motion.translation[order], motion.rotation[order], motion.bound_translation[order])
    return replace(airframe, lattice=moved, motion=modes)


AIRFRAME = flexible_airliner(of_no_symmetry)
# what moments are about need not lie in the plane of symmetry
BESIDE = replace(AIRFRAME, centre_of_gravity=(17.0, 0.7, 0.2))
SHUFFLED = shuffled(BESIDE, np.random.default_rng(0).permutation(len(AIRFRAME.lattice)))
SECTIONS = (Section(length_m=4.0, chord_m=(2.0, 1.0), sweep_deg=20.0, dihedral_deg=5.0),)
WING = wing(SECTIONS, 6, 3, REFERENCE)
FIN_LATTICE, _ = panel(AIRLINER.surfaces.vertical_tail, "fin", 3, 2, vertical=True)
FIN = Airframe(FIN_LATTICE, ModalMotion.none(FIN_LATTICE), REFERENCE, (0.0, 0.0, 0.0))
PAIRS = [
    (frozen(airframe, grid, condition), frozen_whole(airframe, grid, condition))
    for airframe in (AIRFRAME, SHUFFLED, WING, FIN)
    for grid in (GRID, fixed_machs([0.6]))
    for condition in ("exact", "linear")
]
SAMPLES = MIDDLES + RANGES * np.random.default_rng(0).uniform(-1.0, 1.0, (50, len(FEATURES)))


@settings(max_examples=100)
@given(units=UNITS, mach=st.floats(0.2, 0.9), pair=st.sampled_from(PAIRS))
def test_in_halves_it_is_the_whole_lattice(units, mach, pair):
    halved, whole = pair
    assert isinstance(halved.kernel, FrozenHalves)
    u = MIDDLES + RANGES * units
    u[0] = mach
    size = np.abs(whole(SAMPLES)).max(axis=0) + np.abs(whole(u))
    np.testing.assert_array_less(np.abs(halved(u) - whole(u)), 1e-12 * size + 1e-15)


LOPSIDED = {
    "aileron": FIRST_CONTROL + AILERON_LEFT,
    "elevator": FIRST_CONTROL + ELEVATOR_RIGHT,
    "rudder": FIRST_CONTROL + RUDDER,
    "sideslip": BETA,
    "roll": RATE_P,
    "yaw": RATE_R,
    "antisymmetric mode": FIRST_ETA + 3,
    "its rate": FIRST_ETA_RATE + 4,
}


@pytest.mark.parametrize("feature", LOPSIDED.values(), ids=LOPSIDED.keys())
def test_what_is_lopsided_alone_is_felt_alike(feature):
    airframe = flexible_airliner(symmetric_and_antisymmetric)
    halved, whole, again = frozen(airframe, GRID), frozen_whole(airframe, GRID), rebuilt(airframe)
    u = MIDDLES.copy()
    u[0] = GRID.machs()[1]
    straight = whole(u)
    u[feature] = RANGES[feature]
    size = np.abs(whole(SAMPLES)).max(axis=0)
    assert abs(whole(u) - straight)[ROLL] > 1e-3 * size[ROLL]
    np.testing.assert_array_less(np.abs(halved(u) - whole(u)), 1e-12 * size)
    np.testing.assert_array_less(np.abs(halved(u) - again(u)), 1e-11 * size)


def test_every_panel_has_its_image():
    for airframe in (AIRFRAME, SHUFFLED):
        lattice = airframe.lattice
        halves = halves_of(lattice)
        assert halves is not None
        assert sorted(np.concatenate(halves)) == list(range(len(lattice)))
        np.testing.assert_allclose(
            lattice.control[halves.left], lattice.control[halves.right] * MIRROR, rtol=0.0, atol=1e-12
        )
        fin = lattice.surface == lattice.surfaces.index("vertical_tail")
        assert set(halves.middle) == set(np.flatnonzero(fin))


def test_a_wing_has_no_middle_and_a_fin_nothing_else():
    wing_halves, fin_halves = halves_of(WING.lattice), halves_of(FIN_LATTICE)
    assert wing_halves is not None
    assert fin_halves is not None
    assert (len(wing_halves.right), len(wing_halves.middle)) == (18, 0)
    assert (len(fin_halves.right), len(fin_halves.middle)) == (0, 6)


def moved(name: str, panel_number: int, by: float) -> Lattice:
    values = getattr(LATTICE, name).copy()
    values[panel_number] += by * np.array([0.3, 0.5, 0.8])
    return replace(LATTICE, **{name: values})


@settings(max_examples=30)
@given(
    name=st.sampled_from(["start", "end", "control", "normal"]),
    number=st.integers(0, len(LATTICE) - 1),
    by=st.floats(1e-9, 1e-2),
)
def test_one_panel_out_of_place_and_there_are_no_halves(name, number, by):
    assert halves_of(moved(name, number, by)) is None


def test_half_a_wing_has_no_halves():
    half, _ = panel(AIRLINER.surfaces.wing, "wing", 6, 2)
    assert halves_of(half) is None


def test_twins_beside_each_other_are_no_images():
    # both fins' vortices run upwards, so the flow that mirrors one into the other turns its circulation round
    fin = FIN_LATTICE
    aside = [
        replace(fin, start=fin.start + by, end=fin.end + by, control=fin.control + by)
        for by in (np.array([0.0, 1.0, 0.0]), np.array([0.0, -1.0, 0.0]))
    ]
    assert halves_of(Lattice.joined(aside)) is None


def test_what_is_not_symmetric_is_frozen_whole():
    lattice = moved("control", 3, 1e-2)
    airframe = replace(AIRFRAME, lattice=lattice)
    form = frozen(airframe, GRID)
    assert isinstance(form.kernel, Frozen)
    u = MIDDLES.copy()
    u[0] = GRID.machs()[2]
    np.testing.assert_allclose(form(u), rebuilt(airframe)(u), rtol=0.0, atol=1e-10)
