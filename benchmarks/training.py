"""Processor time until a validation nmse, by optimiser, on the cantilever's samples; the airliner's network.

    OMP_NUM_THREADS=1 python benchmarks/training.py

Run alone on the machine. OMP_NUM_THREADS says how many threads the airliner's network has.
"""

import tempfile
import time
from pathlib import Path

from cantilever import cantilever_dataset
from timing import record

from flexsurr.aerodynamics.features import COEFFICIENT_UNITS, COEFFICIENTS, FEATURE_UNITS, FEATURES
from flexsurr.aerodynamics.sampling import draw_features, feature_intervals
from flexsurr.aerodynamics.vortex_lattice import rebuilt
from flexsurr.config.aerodynamics import load_feature_limits
from flexsurr.config.aircraft import load_aircraft
from flexsurr.config.trial import trial_of
from flexsurr.flight.airliner import flexible_airframe
from flexsurr.flight.modes import free_modes
from flexsurr.flight.stick_model import stick_model
from flexsurr.storage import SampleMetadata, Samples
from flexsurr.training import fit, fit_map
from flexsurr.training.map_data import MapData, map_data

AIRCRAFT = Path(__file__).parents[1] / "config" / "aircraft"
SAMPLES, HELD_OUT, SEED = 4096, 0.2, 2024  # as in config/studies/airliner.yaml
LONGEST_S = 10.0
MARKS = (1e-4, 1e-6, 1e-8, 1e-10, 1e-12)

HNN = {"architecture": "hnn", "time_limit_s": LONGEST_S, "epochs": 100_000}
FEW = {"samples_per_trajectory": 20}
ADAM = {"optimiser": "adam_cosine", "epochs": 1500, "batch_size": 64, "learning_rate": 0.01}
PAPER = {"optimiser": "adam", "batch_size": 64, "learning_rate": 1e-5, "precision": "single", "epochs": 5000}
TRIALS = {
    "LM, half_log 16": HNN | {"hidden": (16,), "activation": "half_log"},
    "polynomial, degree 6": {"architecture": "polynomial", "degree": 6, "optimiser": "least_squares"},
    "polynomial, degree 10": {"architecture": "polynomial", "degree": 10, "optimiser": "least_squares"},
    "LM, half_log 16, 20 of each": HNN | FEW | {"hidden": (16,), "activation": "half_log"},
    "LM, even half_log 8": HNN | {"architecture": "even_hnn", "hidden": (8,), "activation": "half_log"},
    "LM, even half_log 8, 20 of each": HNN
    | FEW
    | {"architecture": "even_hnn", "hidden": (8,), "activation": "half_log"},
    "LM, half_log 32": HNN | {"hidden": (32,), "activation": "half_log"},
    "LM, atan 16": HNN | {"hidden": (16,), "activation": "atan"},
    "LM, squareplus 16": HNN | {"hidden": (16,), "activation": "squareplus"},
    "LM, softplus 16": HNN | {"hidden": (16,), "activation": "softplus"},
    "LM, softplus 128": HNN | {"hidden": (128,), "activation": "softplus"},
    "LM, elu 128": HNN | {"hidden": (128,), "activation": "elu"},
    "LM, mlp tanh 32": HNN | {"architecture": "mlp", "hidden": (32,), "activation": "tanh"},
    "L-BFGS, softplus 16": HNN | {"hidden": (16,), "activation": "softplus", "optimiser": "lbfgs"},
    "Adam, cosine, softplus 16": HNN | ADAM | {"hidden": (16,), "activation": "softplus"},
    "Adam as in the paper, elu 128": HNN | PAPER | {"hidden": (128,), "activation": "elu"},
}


def cantilever() -> None:
    dataset = cantilever_dataset("hamiltonian")
    head = "".join(f"{f'to {mark:.0e}':>10}" for mark in MARKS)
    print(f"{'cantilever, s':<32}{head} {'at the end':>11} {'ms an epoch':>12}")
    seconds: dict[float, dict[str, float | None]] = {mark: {} for mark in MARKS}
    more: dict[str, dict[str, float | None]] = {}
    for label, settings in TRIALS.items():
        with tempfile.TemporaryDirectory() as folder:
            result = fit(trial_of(**settings), dataset, folder)
        history = result.history
        cells = ""
        for mark in MARKS:
            reached = history.processor_s[history.validation_loss <= mark]
            seconds[mark][label] = float(reached.iloc[0]) if len(reached) else None
            cells += f"{reached.iloc[0]:>10.2f}" if len(reached) else " " * 10
        an_epoch = result.processor_s / result.epochs
        more[label] = {"nmse": result.validation_nmse, "epoch_s": an_epoch}
        print(f"{label:<32}{cells} {result.validation_nmse:>11.0e} {1e3 * an_epoch:>12.3g}", flush=True)
    for mark in MARKS:
        record(f"the cantilever's surrogate to a validation nmse of {mark:.0e}", seconds[mark], more=more)


def airliner_data() -> MapData:
    """The study's own samples."""
    airframe = flexible_airframe(free_modes(stick_model(load_aircraft(AIRCRAFT / "gnba.yaml"))))
    low, high = feature_intervals(load_feature_limits(AIRCRAFT / "gnba_limits.yaml"))
    u = draw_features(low, high, seed=SEED, first=0, count=SAMPLES)
    metadata = SampleMetadata(
        study="airliner",
        sampling="pseudo_random",
        seed=SEED,
        configuration="",
        first=0,
        count=SAMPLES,
        input_names=FEATURES,
        input_units=FEATURE_UNITS,
        input_low=tuple(low.tolist()),
        input_high=tuple(high.tolist()),
        output_names=COEFFICIENTS,
        output_units=COEFFICIENT_UNITS,
    )
    return map_data(Samples(u, rebuilt(airframe)(u), metadata), HELD_OUT, SEED)


def airliner() -> None:
    trial = trial_of(architecture="network", hidden=(75,), activation="tanh", epochs=250)
    data = airliner_data()
    start = time.perf_counter()
    with tempfile.TemporaryDirectory() as folder:
        result = fit_map(trial, data, folder)
    wall_s = time.perf_counter() - start
    record(
        "training of the airliner's network",
        {f"75 tanh, {result.epochs} epochs": wall_s},
        more={f"75 tanh, {result.epochs} epochs": {"nmse": result.validation_nmse}},
    )
    print(
        f"airliner, 75 tanh, {result.epochs} epochs: {wall_s:.0f} s, of the processor"
        f" {result.processor_s:.0f} s; validation nmse {result.validation_nmse:.2e}"
    )


if __name__ == "__main__":
    cantilever()
    airliner()
