"""Full-order free responses of the cantilever and of the damped wing, against Exudyn and MuJoCo.

    python benchmarks/peers_of_the_beam.py [--seconds 30]   # needs: pip install exudyn mujoco

All three integrate the same chains. The cantilever: ten elements in a plane, a point mass at the middle of
each, a spring at each joint. The wing: sixteen elements that bend and twist, masses beside the axis, rotary
inertia, springs and dampers; the inertia is exact, for neither of the others has the constant one of the
study. A response starts at rest in the shape of the first mode. A code's error is the largest distance of its
tip from that of a far finer solution, over the peak of the tip's motion. Each code runs with several steps or
tolerances, as long and as short as it follows, so that they can be compared at equal errors.

Exudyn steps by its generalised α method without damping of its own. MuJoCo's RK4 is explicit: it follows the
cantilever with short steps; the wing's dampers are too stiff for it, and are stepped by the implicit method,
of first order.
"""

import argparse
import sys
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import yaml
from cantilever import STRUCTURE
from timing import compare
from wing import STRUCTURE as WING

from flexsurr.beam import chain, full_order, node_positions, reduce
from flexsurr.config.structure import JOINTS, Structure
from flexsurr.config.study import Integrator, Reduction
from flexsurr.simulation import simulate

try:
    import exudyn
    import mujoco
    from exudyn.itemInterface import NodeGenericODE2, ObjectKinematicTree
except ImportError as error:
    print(f"left out: {error}")
    sys.exit(3)

OUTPUT_STEP_S = 0.01
REPEATS = 2
FINE = Integrator(method="radau_iia_5", rtol=1e-10, atol=1e-12)
SIGNS = {"in_plane": 1.0, "out_of_plane": -1.0, "torsion": 1.0}  # ours are about z, -y and x
AXES = {"in_plane": "Z", "out_of_plane": "Y", "torsion": "X"}

Tip = np.ndarray  # (times, 3) [m]


@dataclass(frozen=True)
class Case:
    """A response, and the steps and tolerances that each code is tried with."""

    name: str
    structure: Structure
    amplitude: float  # of the first mode, of unit norm [rad]
    tolerances: tuple[float, ...]
    exudyn_steps_s: tuple[float, ...]
    mujoco_steps_s: dict[str, tuple[float, ...]]  # by its integrator

    @property
    def start(self) -> np.ndarray:
        """Joint angles (n,), at rest."""
        return self.amplitude * reduce(self.structure, Reduction(modes=1)).modes[:, 0]

    def tips(self, q: np.ndarray) -> Tip:
        return node_positions(self.structure, q)[..., -1, :]

    def joints(self) -> list[tuple[int, str, int]]:
        """Element, joint and place in q, in the order in which the joints turn."""
        beam = chain(self.structure)
        kinds = [JOINTS[row // beam.elements] for row in beam.rows]
        found = [
            (int(row) % beam.elements, kind, k)
            for k, (row, kind) in enumerate(zip(beam.rows, kinds, strict=True))
        ]
        return sorted(found, key=lambda joint: (joint[0], JOINTS.index(joint[1])))


CASES = (
    Case(
        name="full-order cantilever",
        structure=Structure(**yaml.safe_load(STRUCTURE.read_text())),
        amplitude=0.1,  # the tip moves by a fifth of the span
        tolerances=(1e-3, 1e-4, 1e-5, 1e-6, 1e-7),
        exudyn_steps_s=(1e-3, 2e-4, 1e-4, 5e-5),
        mujoco_steps_s={"RK4": (5e-5, 2.5e-5, 1e-5)},
    ),
    Case(
        name="full-order wing",
        structure=WING.model_copy(update={"rotary_inertia": "exact"}),
        amplitude=0.1,
        tolerances=(1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7),
        exudyn_steps_s=(1e-2, 5e-3, 2e-3, 1e-3),
        mujoco_steps_s={"RK4": (1e-4, 1e-5), "implicit": (1e-2, 1e-3, 1e-4)},
    ),
)


def times(seconds: float) -> np.ndarray:
    return np.linspace(0.0, seconds, round(seconds / OUTPUT_STEP_S) + 1)


def ours(case: Case, integrator: Integrator, t: np.ndarray) -> Callable[[], Tip]:
    model = full_order(case.structure, "hamiltonian", "compiled")
    x0 = np.concatenate([case.start, np.zeros_like(case.start)])
    return lambda: case.tips(simulate(model, t, x0, integrator).x[:, : case.start.size])


def in_exudyn(case: Case, step_s: float, t: np.ndarray) -> Callable[[], Tip]:
    """A kinematic tree of revolute joints, whose coordinates are the joint angles."""
    beam, joints = chain(case.structure), case.joints()
    places = [k for _, _, k in joints]
    signs = np.array([SIGNS[kind] for _, kind, _ in joints])
    count = len(joints)

    def run() -> Tip:
        container = exudyn.SystemContainer()
        system = container.AddSystem()
        zeros = [0.0] * count
        node = system.AddNode(
            NodeGenericODE2(
                referenceCoordinates=zeros,
                initialCoordinates=list(signs * case.start[places]),
                initialCoordinates_t=zeros,
                numberOfODE2Coordinates=count,
            )
        )
        offsets, middles = exudyn.Vector3DList(), exudyn.Vector3DList()
        turns, inertias = exudyn.Matrix3DList(), exudyn.Matrix3DList()
        masses = []
        for number, (element, _, _) in enumerate(joints):
            first = number == 0 or joints[number - 1][0] != element
            last = number == count - 1 or joints[number + 1][0] != element
            offsets.Append(beam.spans[element - 1] if first and element else np.zeros(3))
            middles.Append(beam.arms[element] if last else np.zeros(3))
            turns.Append(np.eye(3))
            tensor = beam.tensors[element] if last and beam.tensors is not None else np.zeros((3, 3))
            inertias.Append(tensor)
            masses.append(beam.masses[element] if last else 0.0)
        system.AddObject(
            ObjectKinematicTree(
                nodeNumber=node,
                jointTypes=[getattr(exudyn.JointType, f"Revolute{AXES[kind]}") for _, kind, _ in joints],
                linkParents=list(np.arange(count) - 1),
                jointTransformations=turns,
                jointOffsets=offsets,
                linkInertiasCOM=inertias,
                linkCOMs=middles,
                linkMasses=masses,
                jointPControlVector=list(beam.stiffness[places]),
                jointPositionOffsetVector=zeros,
                jointDControlVector=list(beam.damping[places]),
                jointVelocityOffsetVector=zeros,
            )
        )
        sensor = system.AddSensor(
            exudyn.itemInterface.SensorNode(
                nodeNumber=node,
                storeInternal=True,
                outputVariableType=exudyn.OutputVariableType.Coordinates,
            )
        )
        system.Assemble()
        settings = exudyn.SimulationSettings()
        settings.timeIntegration.endTime = t[-1]
        settings.timeIntegration.numberOfSteps = round(t[-1] / step_s)
        settings.timeIntegration.automaticStepSize = False
        settings.timeIntegration.verboseMode = 0
        settings.solution.file.write = False
        settings.solution.sensors.writePeriod = OUTPUT_STEP_S
        settings.timeIntegration.generalizedAlpha.spectralRadius = 1.0  # no damping of its own
        system.SolveDynamic(settings, solverType=exudyn.DynamicSolverType.GeneralizedAlpha)
        angles = np.empty((len(t), count))
        angles[:, places] = signs * system.GetSensorStoredData(sensor)[:, 1:]
        return case.tips(angles)

    return run


def in_mujoco(case: Case, integrator: str, step_s: float, t: np.ndarray) -> Callable[[], Tip]:
    """Bodies with hinges."""
    beam, joints = chain(case.structure), case.joints()
    places = [k for _, _, k in joints]
    signs = np.array([SIGNS[kind] for _, kind, _ in joints])
    opened, closed = "", ""
    for element in range(beam.elements):
        root = beam.spans[element - 1] if element else np.zeros(3)
        opened += f'<body pos="{_numbers(root)}">'
        for _, kind, k in (joint for joint in joints if joint[0] == element):
            axis = np.array([AXES[kind] == name for name in "XYZ"], float)
            opened += (
                f'<joint type="hinge" axis="{_numbers(axis)}" stiffness="{beam.stiffness[k]:.17g}"'
                f' damping="{beam.damping[k]:.17g}"/>'
            )
        # a body has to have some inertia
        inertia = np.diag(beam.tensors[element]) if beam.tensors is not None else np.zeros(3)
        opened += (
            f'<inertial pos="{_numbers(beam.arms[element])}" mass="{beam.masses[element]:.17g}"'
            f' diaginertia="{_numbers(np.maximum(inertia, 1e-12))}"/>'
        )
        closed += "</body>"
    text = (
        f'<mujoco><option timestep="{step_s!r}" integrator="{integrator}" gravity="0 0 0">'
        f'<flag contact="disable" constraint="disable"/></option>'
        f"<worldbody>{opened}{closed}</worldbody></mujoco>"
    )
    model = mujoco.MjModel.from_xml_string(text)

    def run() -> Tip:
        data = mujoco.MjData(model)
        data.qpos[:] = signs * case.start[places]
        angles = np.empty((len(t), len(joints)))
        angles[0, places] = signs * data.qpos
        for row in angles[1:]:
            mujoco.mj_step(model, data, nstep=round(OUTPUT_STEP_S / step_s))
            row[places] = signs * data.qpos
            if any(warning.number for warning in data.warning):  # it starts anew where it diverges
                return np.full((len(t), 3), np.inf)
        return case.tips(angles)

    return run


def _numbers(values: np.ndarray) -> str:
    return " ".join(f"{value:.17g}" for value in values)


def against(case: Case, seconds: float) -> None:
    t = times(seconds)
    exact = ours(case, FINE, t)()
    peak = np.max(np.linalg.norm(exact - case.tips(np.zeros_like(case.start)), axis=1))
    runs = {
        f"flexsurr, radau_iia_5 rtol {rtol:g}": ours(
            case, Integrator(method="radau_iia_5", rtol=rtol, atol=1e-2 * rtol), t
        )
        for rtol in case.tolerances
    }
    runs |= {f"Exudyn, generalised α step {h:g} s": in_exudyn(case, h, t) for h in case.exudyn_steps_s}
    for method, steps_s in case.mujoco_steps_s.items():
        runs |= {f"MuJoCo, {method} step {h:g} s": in_mujoco(case, method, h, t) for h in steps_s}
    errors: dict[str, float] = {}

    def noted(name: str, run: Callable[[], Tip]) -> Callable[[], None]:
        def call() -> None:
            error = np.max(np.linalg.norm(run() - exact, axis=1)) / peak
            errors[name] = float(error) if np.isfinite(error) else np.inf

        return call

    calls = {name: noted(name, run) for name, run in runs.items()}
    timings = compare(f"{seconds:g} s of the {case.name}", calls, REPEATS, warmup=0, errors=errors)
    print(f"{case.name}, {seconds:g} s; the tip moves by {peak:.3g} m\n{'':<44}{'s':>10}{'error / peak':>14}")
    for name, timing in timings.items():
        print(f"{name:<44}{timing.median_s:>10.4f}{errors[name]:>14.1e}", flush=True)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seconds", type=float, default=30.0)
    seconds = parser.parse_args().seconds
    mujoco.set_mju_user_warning(lambda _: None)  # of runs that diverge, which their errors say
    for case in CASES:
        against(case, seconds)


if __name__ == "__main__":
    main()
