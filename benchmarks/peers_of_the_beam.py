"""The full-order cantilever's free response, against two multibody codes: Exudyn and MuJoCo.

    python benchmarks/peers_of_the_beam.py        # needs: pip install exudyn mujoco

All three integrate the same chain: ten elements in a plane, a point mass at the middle of each, a spring at
each joint. The response starts at rest in the shape of the first mode. A code's error is the largest distance
of its tip from that of a far finer solution, over the peak of the tip's motion. Each code runs with several
steps or tolerances; what is compared is the time at one error, read off the line between the two
runs around it, both logarithmic. An explicit method that follows at all may be better than that at once.
"""

import itertools
import sys
from collections.abc import Callable

import numpy as np
import yaml
from cantilever import STRUCTURE
from timing import compare

from flexsurr.beam import chain, full_order, node_positions, reduce
from flexsurr.config.structure import Structure
from flexsurr.config.study import Integrator, Reduction
from flexsurr.simulation import simulate

try:
    import exudyn
    import mujoco
    from exudyn.itemInterface import NodeGenericODE2, ObjectKinematicTree
except ImportError as error:
    print(f"left out: {error}")
    sys.exit(3)


DURATION_S, OUTPUT_STEP_S = 5.0, 0.01
AMPLITUDE = 0.1  # of the first mode, of unit norm [rad]: the tip moves by a fifth of the span
EQUAL_ERROR = 1e-4
FOLLOWS = 0.1
REPEATS = 3
FINE = Integrator(method="radau_iia_5", rtol=1e-11, atol=1e-13)
OURS = {
    f"flexsurr, {method} rtol {rtol:g}": Integrator(method=method, rtol=rtol, atol=1e-2 * rtol)
    for method in ("radau_iia_5", "dop853")
    for rtol in (1e-3, 1e-5, 1e-7)
}
EXUDYN_STEPS_S = (2e-4, 1e-4, 5e-5, 2.5e-5)
MUJOCO_STEPS_S = (2.5e-5, 2e-5, 1e-5)

Tip = np.ndarray  # (times, 3) [m]


def structure() -> Structure:
    return Structure(**yaml.safe_load(STRUCTURE.read_text()))


def times() -> np.ndarray:
    return np.linspace(0.0, DURATION_S, round(DURATION_S / OUTPUT_STEP_S) + 1)


def tips(q: np.ndarray) -> Tip:
    return node_positions(structure(), q)[..., -1, :]


def ours(integrator: Integrator, q0: np.ndarray) -> Callable[[], Tip]:
    model = full_order(structure(), "hamiltonian", "compiled")
    x0 = np.concatenate([q0, np.zeros_like(q0)])
    return lambda: tips(simulate(model, times(), x0, integrator).x[:, : q0.size])


def in_exudyn(step_s: float, q0: np.ndarray) -> Callable[[], Tip]:
    """A kinematic tree of revolute joints; its coordinates are the joint angles.

    Its explicit methods follow this response with steps of 1e-5 s alone.
    """
    beam = chain(structure())
    count = beam.elements

    def run() -> Tip:
        container = exudyn.SystemContainer()
        system = container.AddSystem()
        zeros = [0.0] * count
        node = system.AddNode(
            NodeGenericODE2(
                referenceCoordinates=zeros,
                initialCoordinates=list(q0),
                initialCoordinates_t=zeros,
                numberOfODE2Coordinates=count,
            )
        )
        offsets, middles = exudyn.Vector3DList(), exudyn.Vector3DList()
        turns, inertias = exudyn.Matrix3DList(), exudyn.Matrix3DList()
        for k in range(count):
            offsets.Append([0.0 if k == 0 else beam.element_length, 0.0, 0.0])
            middles.Append([0.5 * beam.element_length, 0.0, 0.0])
            turns.Append(np.eye(3))
            inertias.Append(np.zeros((3, 3)))
        system.AddObject(
            ObjectKinematicTree(
                nodeNumber=node,
                # ours lifts the tip where theirs turns about y: the plane is the same, seen from its back
                jointTypes=[exudyn.JointType.RevoluteY] * count,
                linkParents=list(np.arange(count) - 1),
                jointTransformations=turns,
                jointOffsets=offsets,
                linkInertiasCOM=inertias,
                linkCOMs=middles,
                linkMasses=list(beam.masses),
                jointPControlVector=list(beam.stiffness),
                jointPositionOffsetVector=zeros,
                jointDControlVector=zeros,
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
        settings.timeIntegration.endTime = DURATION_S
        settings.timeIntegration.numberOfSteps = round(DURATION_S / step_s)
        settings.timeIntegration.automaticStepSize = False
        settings.timeIntegration.verboseMode = 0
        settings.solution.file.write = False
        settings.solution.sensors.writePeriod = OUTPUT_STEP_S
        settings.timeIntegration.generalizedAlpha.spectralRadius = 1.0  # no damping of its own
        system.SolveDynamic(settings, solverType=exudyn.DynamicSolverType.GeneralizedAlpha)
        return tips(system.GetSensorStoredData(sensor)[:, 1:])

    return run


def in_mujoco(step_s: float, q0: np.ndarray) -> Callable[[], Tip]:
    """Bodies with hinges, RK4."""
    beam = chain(structure())
    opened, closed = "", ""
    for k in range(beam.elements):
        root = 0.0 if k == 0 else beam.element_length
        opened += (
            f'<body pos="{root} 0 0"><joint type="hinge" axis="0 1 0" stiffness="{beam.stiffness[k]:.17g}"/>'
            f'<inertial pos="{0.5 * beam.element_length} 0 0" mass="{beam.masses[k]:.17g}"'
            f' diaginertia="1e-12 1e-12 1e-12"/>'
        )
        closed += "</body>"
    text = (
        f'<mujoco><option timestep="{step_s!r}" integrator="RK4" gravity="0 0 0">'
        f'<flag contact="disable" constraint="disable"/></option>'
        f"<worldbody>{opened}{closed}</worldbody></mujoco>"
    )
    model = mujoco.MjModel.from_xml_string(text)

    def run() -> Tip:
        data = mujoco.MjData(model)
        data.qpos[:] = q0
        angles = [q0.copy()]
        for _ in times()[1:]:
            mujoco.mj_step(model, data, nstep=round(OUTPUT_STEP_S / step_s))
            angles.append(data.qpos.copy())
        return tips(np.array(angles))

    return run


def time_at(error: float, runs: list[tuple[float, float]]) -> float | None:
    """Seconds at which a code reaches `error`, from its (seconds, error); None where no run does.

    Runs that do not follow the response at all, steps too long for an explicit method, do not count.
    """
    following = sorted(run for run in runs if run[1] < FOLLOWS)
    if following and following[0][1] <= error:
        return following[0][0]
    for (fast, coarse), (slow, fine) in itertools.pairwise(following):
        if fine <= error <= coarse:
            share = np.log(coarse / error) / np.log(coarse / fine)
            return float(np.exp(np.log(fast) + share * np.log(slow / fast)))
    return None


def main() -> None:
    basis = reduce(structure(), Reduction(modes=1))
    q0 = AMPLITUDE * basis.modes[:, 0]
    exact = ours(FINE, q0)()
    peak = np.max(np.linalg.norm(exact - tips(np.zeros_like(q0)), axis=1))
    runs = {name: ours(integrator, q0) for name, integrator in OURS.items()}
    runs |= {f"Exudyn, generalised α step {step:g} s": in_exudyn(step, q0) for step in EXUDYN_STEPS_S}
    runs |= {f"MuJoCo, RK4 step {step:g} s": in_mujoco(step, q0) for step in MUJOCO_STEPS_S}
    errors = {name: np.max(np.linalg.norm(run() - exact, axis=1)) / peak for name, run in runs.items()}
    work = f"{DURATION_S:g} s of the full-order cantilever"
    timings = compare(work, runs, REPEATS, warmup=0, errors=errors)
    found: dict[str, list[tuple[float, float]]] = {}
    print(f"{'':<40}{'s':>10}{'error / peak':>14}")
    for name, timing in timings.items():
        error = errors[name]
        method = name.rsplit(" ", 2 if name.startswith("flexsurr") else 3)[0]
        found.setdefault(method, []).append((timing.median_s, error))
        print(f"{name:<40}{timing.median_s:>10.4f}{error:>14.1e}", flush=True)
    print(f"\nat an error of {EQUAL_ERROR:g}:")
    for method, pairs in found.items():
        seconds = time_at(EQUAL_ERROR, pairs)
        print(f"{method:<40}" + ("     no run around it" if seconds is None else f"{seconds:>10.4f} s"))


if __name__ == "__main__":
    main()
