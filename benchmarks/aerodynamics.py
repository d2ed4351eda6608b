"""What one evaluation of the airliner's aerodynamics costs, in each of its forms.

Run alone on the machine:  python benchmarks/aerodynamics.py
Timed within compiled code, as the equations of motion call it; the network also from Python, in NumPy and
in torch, as it leaves its training. Weights are random: they make no difference.
"""

from pathlib import Path

import numpy as np
import torch
from timing import Timing, compare, measure

from flexsurr.aerodynamics.features import COEFFICIENTS, FEATURES
from flexsurr.aerodynamics.mach_grid import fixed_machs, mach_grid
from flexsurr.aerodynamics.quadratic import quadratic
from flexsurr.aerodynamics.sampling import draw_features, feature_intervals
from flexsurr.aerodynamics.vortex_lattice import frozen, rebuilt
from flexsurr.config.aerodynamics import load_feature_limits
from flexsurr.config.aircraft import load_aircraft
from flexsurr.flight.airliner import flexible_airframe
from flexsurr.flight.modes import free_modes
from flexsurr.flight.stick_model import stick_model
from flexsurr.simulation.mapping import CompiledMapping, evaluate_mapping
from flexsurr.surrogates import Intervals, NetworkMap
from flexsurr.training.initialisation import initial_weights
from flexsurr.training.networks import TorchMap
from flexsurr.training.one_hidden_layer import OneHiddenLayer

AIRCRAFT = Path(__file__).parents[1] / "config" / "aircraft"
HIDDEN = 75
CALLS = {"rebuilt": 1, "frozen": 10, "frozen, one Mach number": 30}
COMPILED_CALLS = 2000
PYTHON_CALLS = 200
SAMPLES = 3277


def caller(form: CompiledMapping, u: np.ndarray, calls: int):
    y, work = np.empty((calls, len(COEFFICIENTS))), np.empty(max(form.work_size, 1))
    return lambda: evaluate_mapping(form.kernel, u[:calls], y, work)


def random_network(low: np.ndarray, high: np.ndarray) -> NetworkMap:
    ones = np.ones(len(COEFFICIENTS))
    weights = initial_weights(len(FEATURES), HIDDEN, len(COEFFICIENTS), seed=0, spread=0.2)
    inputs, outputs = Intervals(FEATURES, low, high), Intervals(COEFFICIENTS, -ones, ones)
    return NetworkMap(inputs, outputs, HIDDEN, "tanh", weights)


def show(name: str, timing: Timing, reference_s: float) -> None:
    microseconds = 1e6 * timing.median_s
    relative = 100.0 * timing.median_s / reference_s
    print(f"{name:<32} {microseconds:>10.2f} µs {relative:>10.4f} %")


def main() -> None:
    torch.set_num_threads(1)
    airframe = flexible_airframe(free_modes(stick_model(load_aircraft(AIRCRAFT / "gnba.yaml"))))
    limits = load_feature_limits(AIRCRAFT / "gnba_limits.yaml")
    low, high = feature_intervals(limits)
    grid, one = mach_grid(limits.mach.low, limits.mach.high), fixed_machs([0.7])
    network = random_network(low, high)
    forms = {
        "rebuilt": rebuilt(airframe),
        "frozen": frozen(airframe, grid),
        "frozen, one Mach number": frozen(airframe, one),
        "quadratic": quadratic(airframe, grid),
        "quadratic, one Mach number": quadratic(airframe, one),
        "network, compiled": network.compiled(),
    }
    u = draw_features(low, high, seed=0, first=0, count=COMPILED_CALLS)
    calls = {name: CALLS.get(name, COMPILED_CALLS) for name in forms}
    callers = {name: caller(form, u, calls[name]) for name, form in forms.items()}
    timings = compare("aerodynamics of the airliner", callers, counts=calls)
    reference_s = timings["rebuilt"].median_s
    print(f"{len(airframe.lattice)} panels; one evaluation, of the rebuilt lattice")
    for name, timing in timings.items():
        show(name, timing, reference_s)
    in_torch = TorchMap(network)
    python = {
        "network, NumPy": lambda: [network(u[0]) for _ in range(PYTHON_CALLS)],
        "network, torch": lambda: [in_torch(u[0]) for _ in range(PYTHON_CALLS)],
    }
    for name, timing in compare("aerodynamics from Python", python, counts=PYTHON_CALLS).items():
        show(name, timing, reference_s)
    generator = np.random.default_rng(0)
    x = generator.uniform(-1.0, 1.0, (SAMPLES, len(FEATURES)))
    y = generator.uniform(-1.0, 1.0, (SAMPLES, len(COEFFICIENTS)))
    objective = OneHiddenLayer.of_map(x, y, HIDDEN, "tanh")
    timing = measure(
        "training of the airliner",
        "normal equations",
        lambda: objective.normal_equations(network.parameters),
        repeats=5,
        warmup=1,
    )
    print(f"\nnormal equations of {network.parameter_count} weights at {SAMPLES} samples: {timing}")


if __name__ == "__main__":
    main()
