"""A user's own files: tables in Parquet or CSV, and NPZ archives of arrays, read and checked.

Rows are counted from 1, a CSV file's header left out.
"""

import hashlib
import io
import zipfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from glob import glob
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pyarrow as pa
import pyarrow.csv as csv
from numpy.typing import NDArray

from flexsurr.config.files import Columns, Filter
from flexsurr.storage.files import StorageError
from flexsurr.storage.parquet import read_table

Array = NDArray[np.float64]
Column = NDArray[Any]


@dataclass(frozen=True, eq=False)
class Recording:
    """One trajectory of a file: t (m,) [s], x (m, d), and dx (m, d) where the file holds derivatives.

    `u` (m, d/2) holds the generalised forces on the momenta, where there are any.
    """

    file: str
    t: Array
    x: Array
    dx: Array | None
    u: Array | None = None


@dataclass(frozen=True, eq=False)
class Recordings:
    """The trajectories of all files in their order, and the SHA-256 of each file."""

    trajectories: tuple[Recording, ...]
    sha256: Mapping[str, str]


def find_files(root: Path, patterns: Sequence[str]) -> list[str]:
    """The files that `patterns` name below `root`, each once; a pattern's own in alphabetical order.

    Raises StorageError naming each pattern that no file fits.
    """
    found: dict[str, None] = {}
    problems = []
    for pattern in patterns:
        files = sorted(file for file in glob(pattern, root_dir=root) if (root / file).is_file())
        if not files:
            problems.append(f"{pattern}: no such file (looked in {root.absolute()})")
        found |= dict.fromkeys(files)
    if problems:
        raise StorageError("\n".join(problems))
    return list(found)


def read_recordings(root: Path, files: Sequence[str], columns: Columns, least: int = 2) -> Recordings:
    """Every trajectory of `files`, paths below `root`, one file after another.

    Raises StorageError with a line for each file that cannot be read, lacks a column, or holds what is no
    trajectory of at least `least` samples: naming the file, the column and the row.
    """
    problems: list[str] = []
    trajectories: list[Recording] = []
    sha256 = {}
    for file in files:
        try:
            content = (root / file).read_bytes()
            sha256[file] = hashlib.sha256(content).hexdigest()
            trajectories += _trajectories(file, _read(file, content, columns), columns, least)
        except OSError as error:
            problems.append(f"{file}: cannot be read: {error.strerror}")
        except StorageError as error:
            problems.append(str(error))
    if problems:
        raise StorageError("\n".join(problems))
    return Recordings(tuple(trajectories), sha256)


def filtered(recording: Recording, by: Filter) -> Recording:
    """The trajectory with its own derivatives, or else the filter's; smoothed if that says so."""
    smooth, slope = savitzky_golay(recording.t, recording.x, by.window, by.order)
    return replace(
        recording,
        x=smooth if by.smooth_states else recording.x,
        dx=slope if recording.dx is None else recording.dx,
    )


def _read(file: str, content: bytes, columns: Columns) -> dict[str, Column]:
    """The columns of one file that `columns` names, of one length."""
    reader = READERS.get(Path(file).suffix.lower())
    if reader is None:
        raise StorageError(f"{file}: is of no known kind; allowed: {', '.join(READERS)}")
    try:
        table = reader(content)
    except (pa.ArrowException, ValueError, OSError, zipfile.BadZipFile) as error:
        reason = (str(error).splitlines() or [type(error).__name__])[0]
        raise StorageError(f"{file}: cannot be read as {Path(file).suffix[1:]}: {reason}") from None
    missing = [name for name in columns.named if name not in table]
    if missing:
        raise StorageError(f"{file}: has no column {', '.join(missing)}; there are: {', '.join(table)}")
    wanted = {name: np.asarray(table[name]) for name in columns.named}
    for name, values in wanted.items():
        if values.ndim != 1:
            raise StorageError(f"{file}: {name} is of shape {values.shape}; allowed: a value for each sample")
        if len(values) != len(wanted[columns.t]):
            raise StorageError(
                f"{file}: {name} has {len(values)} values, {columns.t} {len(wanted[columns.t])}"
            )
    return wanted


def _read_csv(content: bytes) -> Mapping[str, Column]:
    table = csv.read_csv(pa.BufferReader(content), read_options=csv.ReadOptions(use_threads=False))
    return {name.strip(): table.column(name).to_numpy() for name in table.column_names}


def _read_parquet(content: bytes) -> Mapping[str, Column]:
    table = read_table(content)
    return {name: table.column(name).to_numpy() for name in table.column_names}


def _read_npz(content: bytes) -> Mapping[str, Column]:
    with np.load(io.BytesIO(content), allow_pickle=False) as archive:
        return {name: archive[name] for name in archive.files}


READERS: dict[str, Callable[[bytes], Mapping[str, Column]]] = {
    ".parquet": _read_parquet,
    ".csv": _read_csv,
    ".npz": _read_npz,
}


def _trajectories(
    file: str, table: Mapping[str, Column], columns: Columns, least: int
) -> Iterator[Recording]:
    numbers = {
        name: _numbers(file, name, values) for name, values in table.items() if name != columns.trajectory
    }
    t = numbers[columns.t]
    x = np.column_stack([numbers[state.column] for state in columns.ordered])
    dx = None
    if columns.have_derivatives:
        dx = np.column_stack([numbers[str(state.derivative)] for state in columns.ordered])
    u = None
    if columns.have_forces:
        none = np.zeros_like(t)
        u = np.column_stack([numbers[p.force.column] if p.force else none for p in columns.pairs])
    for name, rows in _groups(file, table, columns):
        which = "" if name is None else f" of trajectory {name}"
        if len(rows) < least:
            why = "" if least == 2 else ", the window of the filter"
            raise StorageError(f"{file}: {len(rows)} samples{which}; allowed: at least {least}{why}")
        back = np.flatnonzero(np.diff(t[rows]) <= 0.0)
        if back.size:
            before, row = rows[back[0]], rows[back[0] + 1]
            raise StorageError(
                f"{file}: row {row + 1}{which}: {columns.t} is {t[row]:g} after {t[before]:g}; "
                "allowed: a time that increases"
            )
        given = (None if each is None else each[rows] for each in (dx, u))
        yield Recording(file, t[rows], x[rows], *given)


def _groups(
    file: str, table: Mapping[str, Column], columns: Columns
) -> Iterator[tuple[object, NDArray[np.int64]]]:
    """The name and the rows of each trajectory, in order of appearance."""
    if columns.trajectory is None:
        yield None, np.arange(len(table[columns.t]))
        return
    codes, names = pd.factorize(table[columns.trajectory])
    if np.any(codes < 0):
        row = int(np.argmin(codes)) + 1
        raise StorageError(
            f"{file}: row {row}: {columns.trajectory} is missing; allowed: the trajectory's name"
        )
    order = np.argsort(codes, kind="stable")
    starts = np.searchsorted(codes[order], np.arange(len(names) + 1))
    for k, name in enumerate(names):
        yield name, order[starts[k] : starts[k + 1]]


def _numbers(file: str, name: str, values: Column) -> Array:
    """A column as finite numbers."""
    try:
        numbers = values.astype(np.float64)
    except (TypeError, ValueError):
        row = int(np.argmax(pd.to_numeric(pd.Series(values), errors="coerce").isna().to_numpy()))
        raise StorageError(
            f"{file}: row {row + 1}: {name} is {str(values[row])!r:.40}; allowed: a number"
        ) from None
    wrong = np.flatnonzero(~np.isfinite(numbers))
    if wrong.size:
        row = int(wrong[0])
        raise StorageError(f"{file}: row {row + 1}: {name} is {numbers[row]}; allowed: a finite number")
    return numbers


def savitzky_golay(t: Array, x: Array, window: int, order: int) -> tuple[Array, Array]:
    """Smoothed states and their derivatives, (m, d) each, of samples `x` (m, d) at times `t` (m,) [s].

    Around each sample a polynomial of `order` is fitted to `window` samples, the sample in their middle,
    towards the ends as near to it as can be; its value and slope there are the result. Where samples are
    evenly spaced this is `scipy.signal.savgol_filter` with its mode "interp"; here they need not be. Raises
    ValueError for fewer samples than the window.
    """
    if len(t) < window:
        raise ValueError(f"{len(t)} samples are fewer than the window of {window}")
    first = np.clip(np.arange(len(t)) - window // 2, 0, len(t) - window)
    nearby = first[:, None] + np.arange(window)
    away = t[nearby] - t[:, None]
    # in units of the window's length, so that the powers are of one size
    length = away[:, -1] - away[:, 0]
    powers = (away / length[:, None])[..., None] ** np.arange(order + 1)
    coefficients = np.linalg.pinv(powers)[:, :2] @ x[nearby]
    return coefficients[:, 0], coefficients[:, 1] / length[:, None]
