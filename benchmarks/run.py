"""Every benchmark of speed in one sitting, and all that they timed in one table.

    python benchmarks/run.py [--only surrogates integrators] [--output results/tables/benchmarks.csv]

Run alone on the machine. Each row is one case timed in turns with the case that it is held against: the
median of the ratios, its spread (half the distance between the quartiles), seconds, and machine and versions.
A benchmark whose packages are missing is left out, with a line that says so.
"""

import argparse
import os
import platform
import subprocess
import sys
import tempfile
import time
from importlib.metadata import version
from pathlib import Path

import pandas as pd
import psutil
from timing import COLUMNS, ROWS

from flexsurr.cli.training import commit
from flexsurr.storage.files import replacing

HERE = Path(__file__).parent
BENCHMARKS = (
    "integrators",
    "beam_right_hand_sides",
    "structures",
    "surrogates",
    "jacobians",
    "counted",
    "chosen",
    "ensembles",
    "aerodynamics",
    "peers_of_the_beam",
    "peers_of_the_lattice",
    "peers_of_the_surrogates",
    "peers_of_the_integrators",
    "scaling",
    "training",
    "wing_surrogates",
    "wing_without_simulation",
    "planning",
)
MISSING = 3
"""What a benchmark exits with whose optional packages are not there."""
VERSIONS = ("numpy", "numba", "scipy", "torch")


def machine() -> dict[str, str | int]:
    """What every row says of where it was measured."""
    return {
        "processor": _processor(),
        "cores": psutil.cpu_count(logical=False) or 1,
        "python": platform.python_version(),
        **{name: version(name) for name in VERSIONS},
        "commit": commit() or "",
    }


def _processor() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
    except OSError:
        return platform.processor()
    return next((line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")), "")


def run(names: tuple[str, ...], output: Path) -> int:
    """Run them one after another, and write what they timed; the number of those that failed."""
    failed = 0
    with tempfile.TemporaryDirectory() as folder:
        rows = Path(folder) / "rows.csv"
        rows.write_text(",".join(COLUMNS) + "\n")
        began = time.monotonic()
        for number, name in enumerate(names, 1):
            minutes = (time.monotonic() - began) / 60.0
            print(f"== {number} of {len(names)}: {name}, after {minutes:.0f} min", flush=True)
            environment = os.environ | {ROWS: str(rows), "OMP_NUM_THREADS": "1"}
            code = subprocess.run([sys.executable, HERE / f"{name}.py"], env=environment).returncode
            failed += code not in (0, MISSING)
        table = pd.read_csv(rows).assign(**machine())
    with replacing(output) as beside:
        table.to_csv(beside, index=False, float_format="%.4g")
    print(f"{len(table)} rows in {output}" + (f"; {failed} benchmarks failed" if failed else ""))
    return failed


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--only", nargs="+", choices=BENCHMARKS, default=BENCHMARKS, metavar="NAME")
    parser.add_argument("--output", type=Path, default=Path("results/tables/benchmarks.csv"))
    arguments = parser.parse_args()
    return 1 if run(tuple(arguments.only), arguments.output) else 0


if __name__ == "__main__":
    sys.exit(main())
