"""Machine instructions that one right-hand side takes: a count that holds on any machine of this kind.

    python benchmarks/instructions.py             # needs valgrind

Valgrind's callgrind runs this file once more and counts. Beside the count stands, where the formula is short,
the floor that its arithmetic sets: a multiplication with an addition, a division, an activation are one
instruction each, and a layer does `LANES` of them at once. Nothing is timed.
"""

import ctypes
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from cantilever import cantilever_model
from surrogates import call_repeatedly, network, polynomial
from timing import note_instructions
from wing import wing_model

from flexsurr.simulation import CompiledModel
from flexsurr.surrogates import HNN, MLP

CALLS = 2000
COUNTING = "--counting"
MISSING = 3
LANES = 4
"""Numbers of double precision in a vector of 256 bits."""


def even_polynomial(degree: int) -> int:
    """Horner's scheme in q², for ∂H/∂q = q (A(q²) + p² B(q²)) and ∂H/∂p = p C(q²)."""
    return 3 * degree // 2 + 1


def one_layer(width: int, activation: int) -> float:
    """Two inputs and two outputs of each neuron, and its activation."""
    return width * (2 + activation + 2) / LANES


FLOORS = {
    "cantilever, even polynomial of degree 6": even_polynomial(6),
    "cantilever, even polynomial of degree 10": even_polynomial(10),
    "cantilever, HNN of 8, half_log": one_layer(8, 2),  # z / (1 + z²)
    "cantilever, HNN of 32, half_log": one_layer(32, 2),
    "cantilever, MLP of 32, tanh": one_layer(32, 1),
}


def models() -> dict[str, CompiledModel]:
    """Compiled models by name."""
    return {
        "cantilever, compiled reduced model": cantilever_model("hamiltonian"),
        "cantilever, even polynomial of degree 6": polynomial(6, "even"),
        "cantilever, even polynomial of degree 10": polynomial(10, "even"),
        "cantilever, HNN of 8, half_log": network(HNN, (8,), "half_log"),
        "cantilever, HNN of 32, half_log": network(HNN, (32,), "half_log"),
        "cantilever, MLP of 32, tanh": network(MLP, (32,), "tanh"),
        "wing, compiled reduced model": wing_model("hamiltonian"),
    }


def call(model: CompiledModel, calls: int) -> None:
    size = len(model.state_names)
    x, dx, work = np.full(size, 0.1), np.empty(size), np.empty(model.work_size)
    call_repeatedly(model.kernel, 0.0, x, dx, work, calls)


def count() -> None:
    """Under callgrind: call each model between two marks, a function at which counts are written down."""
    mark = ctypes.CDLL(None).drand48
    for model in models().values():
        call(model, 1)
        mark()
        call(model, CALLS)
        mark()
        call(model, 2 * CALLS)
        mark()


def counted(folder: Path) -> list[int]:
    """Instructions between one mark and the next."""
    command = [
        "valgrind",
        "--tool=callgrind",
        "--dump-before=drand48",
        f"--callgrind-out-file={folder}/out",
        sys.executable,
        __file__,
        COUNTING,
    ]
    subprocess.run(command, check=True, stderr=subprocess.DEVNULL)
    parts = sorted(folder.glob("out.*"), key=lambda path: int(path.suffix[1:]))
    return [int(re.search(r"^(?:summary|totals): (\d+)", part.read_text(), re.M)[1]) for part in parts]


def main() -> int:
    if COUNTING in sys.argv:
        count()
        return 0
    if shutil.which("valgrind") is None:
        print("left out: no valgrind on the PATH")
        return MISSING
    for model in models().values():
        call(model, 1)  # compiled before: the compiler's instructions are not of interest
    with tempfile.TemporaryDirectory() as folder:
        marks = counted(Path(folder))
    counts = {name: (marks[3 * k + 2] - marks[3 * k + 1]) / CALLS for k, name in enumerate(models())}
    note_instructions("instructions of a right-hand side", counts)
    print(f"{'instructions a right-hand side':<44}{'count':>8}{'floor':>8}")
    for name, number in counts.items():
        floor = f"{FLOORS[name]:>8.0f}" if name in FLOORS else ""
        print(f"{name:<44}{number:>8.0f}{floor}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
