"""Validation loss against wall time, by optimiser, on the cantilever's 8,040 samples.

Run alone on the machine:  python benchmarks/training.py
"""

import tempfile

import numpy as np
from cantilever import cantilever_dataset

from flexsurr.config.trial import trial_of
from flexsurr.training import fit

LONGEST_S = 10.0
MARKS_S = (0.5, 1.0, 2.0, 4.0, 8.0)

HNN = {"architecture": "hnn", "time_limit_s": LONGEST_S, "epochs": 100_000}
ADAM = {"optimiser": "adam_cosine", "epochs": 1500, "batch_size": 64, "learning_rate": 0.01}
PAPER = {"optimiser": "adam", "batch_size": 64, "learning_rate": 1e-5, "precision": "single", "epochs": 5000}
TRIALS = {
    "polynomial, degree 6": {"architecture": "polynomial", "degree": 6, "optimiser": "least_squares"},
    "polynomial, degree 10": {"architecture": "polynomial", "degree": 10, "optimiser": "least_squares"},
    "LM, half_log 16": HNN | {"hidden": (16,), "activation": "half_log"},
    "LM, squareplus 16": HNN | {"hidden": (16,), "activation": "squareplus"},
    "LM, softplus 16": HNN | {"hidden": (16,), "activation": "softplus"},
    "LM, softplus 128": HNN | {"hidden": (128,), "activation": "softplus"},
    "LM, elu 128": HNN | {"hidden": (128,), "activation": "elu"},
    "LM, mlp tanh 32": HNN | {"architecture": "mlp", "hidden": (32,), "activation": "tanh"},
    "L-BFGS, softplus 16": HNN | {"hidden": (16,), "activation": "softplus", "optimiser": "lbfgs"},
    "Adam, cosine, softplus 16": HNN | ADAM | {"hidden": (16,), "activation": "softplus"},
    "Adam as in the paper, elu 128": HNN | PAPER | {"hidden": (128,), "activation": "elu"},
}


def main() -> None:
    dataset = cantilever_dataset("hamiltonian")
    print(
        f"{'validation nmse':<32}", *(f"{mark:>7g} s" for mark in MARKS_S), f"{'end':>9} {'ms an epoch':>12}"
    )
    for label, settings in TRIALS.items():
        with tempfile.TemporaryDirectory() as folder:
            result = fit(trial_of(**settings), dataset, folder)
        history = result.history
        best = np.minimum.accumulate(history.validation_loss)
        cells = [
            f"{best[history.wall_s <= mark].iloc[-1]:>9.0e}" if (history.wall_s <= mark).any() else " " * 9
            for mark in MARKS_S
        ]
        pace = 1e3 * result.wall_s / result.epochs
        print(f"{label:<32}", *cells, f"{result.validation_nmse:>9.0e} {pace:>12.3g}", flush=True)


if __name__ == "__main__":
    main()
