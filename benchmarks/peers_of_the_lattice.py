"""One evaluation of a wing's vortex lattice, against AVL, AeroSandbox, OpenAeroStruct, PanelAero.

    python benchmarks/peers_of_the_lattice.py     # needs: pip install aerosandbox openaerostruct panelaero

A swept, tapered wing with 480 panels. Each code builds its matrix of influences and solves it for one angle
of attack, from Python, as its manual shows; what does not depend on the flow is prepared before. Errors are
those of the lift, as a part of ours: they solve the same problem.
"""

import math
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path

import numpy as np
from timing import compare

from flexsurr.aerodynamics.airframe import Airframe, ModalMotion
from flexsurr.aerodynamics.features import ALPHA, FEATURES, LIFT, MACH, ReferenceDimensions
from flexsurr.aerodynamics.lattice import Lattice, panel
from flexsurr.aerodynamics.vortex_lattice import rebuilt
from flexsurr.config.aircraft import Section, Surface

try:
    import aerosandbox
    import openmdao.api as openmdao
    from openaerostruct.aerodynamics.aero_groups import AeroPoint
    from openaerostruct.geometry.geometry_group import Geometry
    from optvl import OVLSolver
    from panelaero import VLM
except ImportError as error:
    print(f"left out: {error}")
    sys.exit(3)


HALF_SPAN, ROOT, TIP, SWEPT = 4.0, 1.4, 0.6, 2.0  # [m]
STRIPS, CHORDWISE = 20, 12  # of one half
ALPHA_DEG, SPEED = 5.0, 50.0
AREA = HALF_SPAN * (ROOT + TIP)
REPEATS = 20

AVL = f"""wing
0.0
0 0 0.0
{AREA} 1.0 {2.0 * HALF_SPAN}
0.25 0.0 0.0
0.0
SURFACE
Wing
{CHORDWISE} 0.0 {STRIPS} 0.0
YDUPLICATE
0.0
SECTION
0.0 0.0 0.0 {ROOT} 0.0
SECTION
{SWEPT} {HALF_SPAN} 0.0 {TIP} 0.0
"""

Lift = Callable[[], float]


def our_lattice() -> Lattice:
    sweep = math.degrees(math.atan(SWEPT / HALF_SPAN))
    section = Section(length_m=HALF_SPAN, chord_m=(ROOT, TIP), sweep_deg=sweep)
    surface = Surface(source="assumed", root_m=(0.0, 0.0, 0.0), sections=(section,), elastic_axis=(0.4,))
    right, _ = panel(surface, "wing", STRIPS, CHORDWISE)
    return Lattice.joined([right, right.mirrored()])


def ours() -> Lift:
    lattice = our_lattice()
    reference = ReferenceDimensions(AREA, 1.0, 2.0 * HALF_SPAN)
    form = rebuilt(Airframe(lattice, ModalMotion.none(lattice), reference, (0.25, 0.0, 0.0)))
    u = np.zeros(len(FEATURES))
    u[MACH], u[ALPHA] = 0.0, math.radians(ALPHA_DEG)
    return lambda: float(form(u)[LIFT])


def avl(folder: Path) -> Lift:
    path = folder / "wing.avl"
    path.write_text(AVL)
    solver = OVLSolver(geo_file=str(path))
    turns = iter(range(1, 1_000_000))

    def lift() -> float:
        # another Mach number each time, else the matrix of the last run is kept
        solver.set_parameter("Mach", 1e-6 * next(turns))
        solver.set_variable("alpha", ALPHA_DEG)
        solver.execute_run()
        return float(solver.get_total_forces()["CL"])

    return lift


def in_aerosandbox() -> Lift:
    flat = aerosandbox.Airfoil("naca0002")
    sections = [
        aerosandbox.WingXSec(xyz_le=[0.0, 0.0, 0.0], chord=ROOT, airfoil=flat),
        aerosandbox.WingXSec(xyz_le=[SWEPT, HALF_SPAN, 0.0], chord=TIP, airfoil=flat),
    ]
    wing = aerosandbox.Wing(xsecs=sections, symmetric=True)
    plane = aerosandbox.Airplane(
        wings=[wing], s_ref=AREA, c_ref=1.0, b_ref=2.0 * HALF_SPAN, xyz_ref=[0.25, 0.0, 0.0]
    )
    flow = aerosandbox.OperatingPoint(velocity=SPEED, alpha=ALPHA_DEG)

    def lift() -> float:
        analysis = aerosandbox.VortexLatticeMethod(
            plane, flow, spanwise_resolution=STRIPS, chordwise_resolution=CHORDWISE
        )
        return float(analysis.run()["CL"])

    return lift


def in_openaerostruct() -> Lift:
    y = -HALF_SPAN * np.linspace(1.0, 0.0, STRIPS + 1)
    share = np.linspace(0.0, 1.0, CHORDWISE + 1)[:, None]
    eta = np.abs(y) / HALF_SPAN
    mesh = np.zeros((CHORDWISE + 1, STRIPS + 1, 3))
    mesh[..., 0] = SWEPT * eta + share * (ROOT + (TIP - ROOT) * eta)
    mesh[..., 1] = y
    surface = {
        "name": "wing",
        "symmetry": True,
        "S_ref_type": "projected",
        "mesh": mesh,
        "CL0": 0.0,
        "CD0": 0.0,
        "with_viscous": False,
        "with_wave": False,
        "k_lam": 0.05,
        "t_over_c_cp": np.array([0.02]),
        "c_max_t": 0.3,
    }
    problem = openmdao.Problem(reports=None)
    flow = openmdao.IndepVarComp()
    flow.add_output("v", val=SPEED, units="m/s")
    flow.add_output("alpha", val=ALPHA_DEG, units="deg")
    flow.add_output("beta", val=0.0, units="deg")
    flow.add_output("Mach_number", val=0.0)
    flow.add_output("re", val=1e6, units="1/m")
    flow.add_output("rho", val=1.0, units="kg/m**3")
    flow.add_output("cg", val=np.zeros(3), units="m")
    problem.model.add_subsystem("flow", flow, promotes=["*"])
    problem.model.add_subsystem("wing", Geometry(surface=surface))
    inputs = ["v", "alpha", "beta", "Mach_number", "re", "rho", "cg"]
    problem.model.add_subsystem("point", AeroPoint(surfaces=[surface]), promotes_inputs=inputs)
    problem.model.connect("wing.mesh", "point.wing.def_mesh")
    problem.model.connect("wing.mesh", "point.aero_states.wing_def_mesh")
    problem.model.connect("wing.t_over_c", "point.wing_perf.t_over_c")
    problem.setup()
    problem.set_solver_print(level=-1)

    def lift() -> float:
        problem.run_model()
        return float(problem["point.wing_perf.CL"][0])

    return lift


def in_panelaero() -> Lift:
    grid_of = our_lattice()
    arrays = {
        "offset_P1": grid_of.start,
        "offset_P3": grid_of.end,
        "offset_j": grid_of.control,
        "N": grid_of.normal,
    }
    chord = grid_of.corners[:, [3, 2], 0] - grid_of.corners[:, [0, 1], 0]
    span = np.abs(grid_of.end[:, 1] - grid_of.start[:, 1])
    grid = {"n": len(grid_of), "A": chord.mean(axis=1) * span, "l": chord.mean(axis=1)}
    alpha = math.radians(ALPHA_DEG)

    def lift() -> float:
        # it writes into the arrays that it is given
        copies = {name: array.copy() for name, array in arrays.items()}
        with np.errstate(all="ignore"):  # it divides by zero and puts the result right
            influence, _ = VLM.calc_Qjj({**grid, **copies}, Ma=0.0)
        pressures = influence @ np.full(len(grid_of), -alpha)
        return float(np.abs(np.sum(pressures * grid["A"])) / AREA)

    return lift


def main() -> None:
    with tempfile.TemporaryDirectory() as folder:
        codes = {
            "flexsurr": ours(),
            "AVL": avl(Path(folder)),
            "AeroSandbox": in_aerosandbox(),
            "OpenAeroStruct": in_openaerostruct(),
            "PanelAero": in_panelaero(),
        }
        lifts = {name: code() for name, code in codes.items()}
        apart = {name: abs(lift / lifts["flexsurr"] - 1.0) for name, lift in lifts.items()}
        more = {name: {"lift_coefficient": lift} for name, lift in lifts.items()}
        work = f"lattice of {2 * STRIPS * CHORDWISE} panels"
        timings = compare(work, codes, REPEATS, errors=apart, more=more)
        print(f"{'':<20}{'ms':>10}{'of ours':>10}{'lift coefficient':>20}")
        for name, timing in timings.items():
            print(f"{name:<20}{1e3 * timing.median_s:>10.2f}{timing.ratio:>10.1f}{lifts[name]:>20.5f}")


if __name__ == "__main__":
    main()
