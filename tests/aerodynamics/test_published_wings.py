"""Wings of the literature, and another lattice code."""

import importlib.metadata
import math
import os
from pathlib import Path

import numpy as np
import pytest
from optvl import OVLSolver
from wings import lift_drag_moment, wing

from flexsurr.aerodynamics.features import ALPHA, FEATURES, LIFT, MACH, ReferenceDimensions
from flexsurr.aerodynamics.vortex_lattice import rebuilt
from flexsurr.config.aircraft import Section


@pytest.mark.parametrize(("strips", "chordwise", "published"), [(4, 1, 3.443), (20, 6, 3.238)])
def test_the_swept_wing_of_bertin_and_smith(strips, chordwise, published):
    # Bertin, Smith, Aerodynamics for Engineers, example 7.2: aspect ratio 5, 45° of sweep, no taper
    section = Section(length_m=0.5, chord_m=(0.2, 0.2), sweep_deg=45.0)
    airframe = wing((section,), strips, chordwise, ReferenceDimensions(0.2, 0.2, 1.0))
    u = np.zeros(len(FEATURES))
    u[MACH], u[ALPHA] = 0.0, 1e-4
    lift = rebuilt(airframe)(u)[LIFT] / 1e-4
    assert lift == pytest.approx(published, rel=5e-4)


def test_the_warren_12_wing():
    # a planform much used to compare methods: aspect ratio 2√2, taper 1/3, moments about the apex
    span = 2.0 * math.sqrt(2.0)
    section = Section(length_m=0.5 * span, chord_m=(1.5, 0.5), sweep_deg=53.54)
    lift, _, moment = lift_drag_moment(wing((section,), 16, 6, ReferenceDimensions(span, 1.0, span)), 1e-4)
    assert lift / 1e-4 == pytest.approx(2.743, rel=0.03)
    assert moment / 1e-4 == pytest.approx(-3.10, rel=0.03)


def test_an_elliptic_wing_has_the_least_induced_drag():
    def efficiency(sections: int) -> float:
        span, root = 8.0, 1.0
        y = np.sin(np.linspace(0.0, 0.5 * math.pi, sections + 1))
        y[-1] = 0.9999  # a tip of no chord is no panel
        chord = root * np.sqrt(1.0 - y**2)
        edge, y = -0.25 * chord, 0.5 * span * y  # the quarter-chord line is straight
        parts = tuple(
            Section(
                length_m=y[k + 1] - y[k],
                chord_m=(chord[k], chord[k + 1]),
                sweep_deg=math.degrees(math.atan((edge[k + 1] - edge[k]) / (y[k + 1] - y[k]))),
            )
            for k in range(sections)
        )
        area = 0.25 * math.pi * span * root
        airframe = wing(parts, 2 * sections, 4, ReferenceDimensions(area, root, span))
        lift, drag, _ = lift_drag_moment(airframe, math.radians(4.0))
        return lift**2 / (math.pi * span**2 / area) / drag

    coarse, fine = efficiency(10), efficiency(20)
    # the lattice errs by the first power of the strips' width
    assert abs(fine - 1.0) < 0.6 * abs(coarse - 1.0)
    assert 2.0 * fine - coarse == pytest.approx(1.0, abs=0.01)


GEOMETRY = """swept, tapered wing with dihedral
0.0
0 0 0.0
8.0 1.0 8.0
0.25 0.0 0.0
0.0
SURFACE
Wing
6 0.0 12 0.0
YDUPLICATE
0.0
SECTION
0.0 0.0 0.0 1.4 0.0
SECTION
2.0 4.0 0.3 0.6 0.0
"""


@pytest.fixture(scope="module")
def avl(tmp_path_factory):
    path = tmp_path_factory.mktemp("avl") / "wing.avl"
    path.write_text(GEOMETRY)
    # optvl looks for its libraries behind a link in /tmp. It stops where that link leads to an environment
    # that is gone, and where two processes make it at once: so the link is there before, made in one step
    libraries = Path(importlib.metadata.distribution("optvl").locate_file("optvl.libs")).resolve()
    link = Path(f"/tmp/optvl.libs.{os.getpid()}")
    link.symlink_to(libraries)
    link.replace("/tmp/optvl.libs")
    return OVLSolver(geo_file=str(path))


@pytest.mark.parametrize("mach", [0.0, 0.7])
def test_lift_induced_drag_and_moment_are_those_of_avl(avl, mach):
    length = math.hypot(4.0, 0.3)
    section = Section(
        length_m=length,
        chord_m=(1.4, 0.6),
        sweep_deg=math.degrees(math.atan(2.0 / length)),
        dihedral_deg=math.degrees(math.atan(0.3 / 4.0)),
    )
    airframe = wing((section,), 12, 6, ReferenceDimensions(8.0, 1.0, 8.0), (0.25, 0.0, 0.0))
    lift, drag, moment = lift_drag_moment(airframe, math.radians(5.0), mach)
    avl.set_variable("alpha", 5.0)
    avl.set_parameter("Mach", mach)
    avl.execute_run()
    theirs = avl.get_total_forces()
    assert lift == pytest.approx(float(theirs["CL"]), rel=1e-6)
    assert drag == pytest.approx(float(theirs["CDi"]), rel=1e-6)
    assert moment == pytest.approx(float(theirs["Cm"]), rel=1e-6)
