"""Folders of runs as training leaves them."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

COMMIT = "c" * 40
SHA256 = "0123456789abcdef" * 4


def described(key: str, study: str = "cantilever", **trial: Any) -> dict[str, Any]:
    """What a run's parameters.json says."""
    return {
        "run_id": key,
        "study": study,
        "variant": "hamiltonian",
        "dataset": "default",
        "trial": {"architecture": "hnn", "seed": 3, "epochs": 40, **trial},
        "dataset_sha256": SHA256,
        "commit": COMMIT,
    }


def write_run(runs: Path, key: str, study: str = "cantilever", epochs: int = 3, **fit: Any) -> Path:
    """The folder of a run, with files of a training of some `epochs`; `fit` is said of it in fit.json too."""
    folder = runs / key
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "parameters.json").write_text(json.dumps(described(key, study)))
    if not (folder / "weights.npz").exists():
        (folder / "weights.npz").write_bytes(b"weights")
    number = np.arange(epochs)
    columns = {"epoch": number, "wall_s": 0.5 * number, "train_loss": 1.0 / (1.0 + number)}
    columns["validation_loss"] = 2.0 / (1.0 + number)
    pq.write_table(pa.table(columns), folder / "history.parquet")
    content = {"run_id": key, "study": study, "status": "finished", "reason": "", "seed": 3, "epochs": epochs}
    content |= {"epoch_limit": 40, "best_epoch": 1, "parameters": 130, "wall_s": 1.5, "train_nmse": 1e-9}
    (folder / "fit.json").write_text(json.dumps(content | fit))
    return folder


def write_scores(folder: Path, **scores: float) -> None:
    """A run's metrics.json."""
    fit = json.loads((folder / "fit.json").read_text())
    (folder / "metrics.json").write_text(json.dumps(fit | scores))
