"""Every benchmark of speed in one sitting, and all that they timed in one table.

    python benchmarks/run.py [--only surrogates integrators] [--output results/tables/benchmarks.csv]

Run alone on the machine. Each row is one case timed in turns with the case that it is held against: the
median of the ratios, its spread (half the distance between the quartiles), seconds, and machine and versions.
Rows of benchmarks that do not run, or fail, stay as they are in the file. A benchmark whose packages are
missing is left out, with a line that says so.
"""

import argparse
import json
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
    "peers_of_training",
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
    failed, came = 0, [table_of([])]
    where = machine()
    began = time.monotonic()
    with tempfile.TemporaryDirectory() as folder:
        for number, name in enumerate(names, 1):
            minutes = (time.monotonic() - began) / 60.0
            print(f"== {number} of {len(names)}: {name}, after {minutes:.0f} min", flush=True)
            rows = Path(folder) / f"{name}.jsonl"
            rows.touch()
            environment = os.environ | {ROWS: str(rows), "OMP_NUM_THREADS": "1"}
            code = subprocess.run([sys.executable, HERE / f"{name}.py"], env=environment).returncode
            failed += code not in (0, MISSING)
            if code == 0:
                came.append(table_of(rows.read_text(encoding="utf-8").splitlines()).assign(**where))
    table = merged(pd.read_csv(output) if output.exists() else table_of([]), pd.concat(came))
    with replacing(output) as beside:
        table.to_csv(beside, index=False, float_format="%.6g")
    print(f"{len(table)} rows in {output}" + (f"; {failed} benchmarks failed" if failed else ""))
    return failed


def table_of(lines: list[str]) -> pd.DataFrame:
    """The rows that a benchmark has added, those columns first that every benchmark has."""
    found = pd.DataFrame([json.loads(line) for line in lines])
    return found.reindex(columns=[*COLUMNS, *found.columns.difference(COLUMNS, sort=False)])


def merged(before: pd.DataFrame, now: pd.DataFrame) -> pd.DataFrame:
    """Rows of `before`, those of benchmarks that ran again replaced, in the order of a whole sitting."""
    kept = before[~before["subject"].isin(now["subject"])]
    table = pd.concat([part for part in (kept, now) if len(part)] or [now])
    place = table["subject"].map({name: k for k, name in enumerate(BENCHMARKS)})
    return table.iloc[place.argsort(kind="stable")]


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--only", nargs="+", choices=BENCHMARKS, default=BENCHMARKS, metavar="NAME")
    parser.add_argument("--output", type=Path, default=Path("results/tables/benchmarks.csv"))
    arguments = parser.parse_args()
    return 1 if run(tuple(arguments.only), arguments.output) else 0


if __name__ == "__main__":
    sys.exit(main())
