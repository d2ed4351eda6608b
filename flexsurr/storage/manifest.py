"""The manifest of a dataset: its shards with their hashes, the split, the scales.

Shards are read one at a time, so that memory does not grow with their number.
"""

import hashlib
import json
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from flexsurr.storage.files import DamagedFile, StorageError, read_json, write_json
from flexsurr.storage.parquet import FORMAT_VERSION, Shard, ShardMetadata, read_shard
from flexsurr.storage.scales import Moments, Scales

SplitBy = Literal["trajectory", "sample"]

SPLIT_STREAM = (0, 1)  # keeps the split's random numbers apart from those of any trajectory


@dataclass(frozen=True)
class ShardEntry:
    """One shard: its file beside the manifest, its hash, and the trajectories first … first + count − 1."""

    file: str
    sha256: str
    first: int
    count: int
    samples: int


@dataclass(frozen=True)
class Manifest:
    """A dataset. `folder` is where the manifest was read from or will be written to.

    `train` and `validation` are the numbers of the trajectories; where the split is by sample, every
    trajectory is in both. `scales` are those of the training samples. `origin` is where the trajectories
    come from unless they were simulated: the SHA-256 of each of the user's files, whether their derivatives
    were given or estimated, and the filter that they went through.
    """

    folder: Path
    study: str
    variant: str
    seed: int
    configuration: str
    state_names: tuple[str, ...]
    state_units: tuple[str, ...]
    shards: tuple[ShardEntry, ...]
    train: tuple[int, ...]
    validation: tuple[int, ...]
    scales: Scales
    failures: tuple[str, ...]
    split_by: SplitBy = "trajectory"
    training_fraction: float = 0.8
    origin: dict[str, Any] | None = None
    format_version: int = FORMAT_VERSION

    @property
    def trajectories(self) -> int:
        """Number of trajectories."""
        return sum(entry.count for entry in self.shards)

    @property
    def samples(self) -> int:
        """Number of samples of all trajectories."""
        return sum(entry.samples for entry in self.shards)

    def training_rows(self, shard: Shard) -> NDArray[np.bool_]:
        """Which samples (m,) of one of its shards train; the others validate."""
        return _training_rows(shard, self.split_by, self.train, self.training_fraction, self.seed)

    @property
    def sha256(self) -> str:
        """The hash of all that training depends on: the states, what the shards hold, and the split."""
        shards = [entry.sha256 for entry in self.shards]
        content: list[object] = [self.state_names, self.state_units, shards, self.train, self.validation]
        if self.split_by == "sample":
            content += [self.seed, self.training_fraction]
        return hashlib.sha256(json.dumps(content).encode()).hexdigest()


def split_samples(shard: Shard, training_fraction: float, seed: int) -> NDArray[np.bool_]:
    """Which samples (m,) of a shard train: so many of them, in a random choice of its own.

    Neither part is empty where the shard has two samples.
    """
    count = len(shard.t)
    order = np.random.default_rng([seed, *SPLIT_STREAM, shard.metadata.first]).permutation(count)
    rows = np.zeros(count, dtype=np.bool_)
    rows[order[: min(max(round(training_fraction * count), 1), count - 1)]] = True
    return rows


def split_trajectories(
    count: int, training_fraction: float, seed: int
) -> tuple[tuple[int, ...], tuple[int, ...]]:
    """Numbers of the training and of the validation trajectories; neither is empty for `count` ≥ 2."""
    order = np.random.default_rng([seed, *SPLIT_STREAM]).permutation(count)
    training = min(max(round(training_fraction * count), 1), count - 1)
    return tuple(sorted(order[:training].tolist())), tuple(sorted(order[training:].tolist()))


def _training_rows(
    shard: Shard, split_by: SplitBy, train: tuple[int, ...], training_fraction: float, seed: int
) -> NDArray[np.bool_]:
    if split_by == "sample":
        return split_samples(shard, training_fraction, seed)
    return np.isin(shard.trajectory, train)


def build_manifest(
    paths: Sequence[Path],
    *,
    study: str,
    variant: str,
    seed: int,
    configuration: str,
    trajectories: int,
    split_by: SplitBy,
    training_fraction: float,
    origin: dict[str, Any] | None = None,
) -> Manifest:
    """The manifest of the shards at `paths`, which all lie in one folder.

    Raises StorageError naming each shard that is damaged, belongs to another dataset than the one
    described, or leaves a trajectory out or gives it twice; and each state or rate that does not vary over
    the training samples, to which no error is relative.
    """
    if split_by == "sample":
        train = validation = tuple(range(trajectories))
    else:
        train, validation = split_trajectories(trajectories, training_fraction, seed)
    damaged, entries, moments = [], [], None
    failures: list[str] = []
    states: ShardMetadata | None = None
    for path in sorted(paths, key=lambda path: path.name):
        try:
            shard = read_shard(path)
            expected = replace(
                shard.metadata, study=study, variant=variant, seed=seed, configuration=configuration
            )
            _check_belongs(path, shard.metadata, expected)
            if states and (shard.metadata.state_names, shard.metadata.state_units) != (
                states.state_names,
                states.state_units,
            ):
                raise DamagedFile(f"{path}: has other states or units than the shards before it")
        except DamagedFile as error:
            damaged.append(str(error))
            continue
        states = shard.metadata
        failures += shard.metadata.failures
        entries.append(_entry(path, shard))
        rows = _training_rows(shard, split_by, train, training_fraction, seed)
        block = Moments.of(np.hstack([shard.x, shard.dx])[rows])
        moments = block if moments is None else moments.joined(block)
    if damaged:
        raise DamagedFile("\n".join(damaged))
    problems = _check_complete(entries, trajectories)
    if problems or states is None or moments is None:
        raise StorageError("\n".join(problems) or "a dataset without shards")
    names = [*states.state_names, *(f"the rate of {name}" for name in states.state_names)]
    if still := [
        name for name, low, high in zip(names, moments.low, moments.high, strict=True) if low == high
    ]:
        raise StorageError(f"{paths[0].parent}: no training samples vary in {', '.join(still)}")
    return Manifest(
        folder=paths[0].parent,
        study=study,
        variant=variant,
        seed=seed,
        configuration=configuration,
        state_names=states.state_names,
        state_units=states.state_units,
        shards=tuple(sorted(entries, key=lambda entry: entry.first)),
        train=train,
        validation=validation,
        scales=Scales.of_moments(moments),
        failures=tuple(failures),
        split_by=split_by,
        training_fraction=training_fraction,
        origin=origin,
    )


def write_manifest(path: Path, manifest: Manifest) -> None:
    """Write the manifest as JSON, atomically."""
    content = asdict(manifest)
    del content["folder"]
    write_json(path, content)


def read_manifest(path: Path) -> Manifest:
    """The manifest at `path`. Raises StorageError naming the file if it is missing or not a manifest."""
    values = read_json(path, ["format_version"])
    if (version := values["format_version"]) != FORMAT_VERSION:
        raise DamagedFile(f"{path}: has format version {version}; this program reads {FORMAT_VERSION}")
    try:
        for key in ("state_names", "state_units", "train", "validation", "failures"):
            values[key] = tuple(values[key])
        values["shards"] = tuple(ShardEntry(**entry) for entry in values["shards"])
        values["scales"] = Scales(**{key: tuple(numbers) for key, numbers in values["scales"].items()})
        return Manifest(folder=path.parent, **values)
    except (TypeError, KeyError, AttributeError):
        raise DamagedFile(f"{path}: cannot be understood as a manifest") from None


def read_shards(manifest: Manifest) -> Iterator[Shard]:
    """The shards of a dataset, one after another, each checked against what the manifest recorded.

    Raises StorageError naming the shard that is not the recorded file or belongs elsewhere.
    """
    for entry in manifest.shards:
        yield _read_recorded(manifest, entry)  # kept in no variable: whoever asks for the next has this one


def _read_recorded(manifest: Manifest, entry: ShardEntry) -> Shard:
    path = manifest.folder / entry.file
    shard = read_shard(path, entry.sha256)
    expected = replace(
        shard.metadata,
        study=manifest.study,
        variant=manifest.variant,
        seed=manifest.seed,
        configuration=manifest.configuration,
        state_names=manifest.state_names,
        state_units=manifest.state_units,
        first=entry.first,
        count=entry.count,
    )
    _check_belongs(path, shard.metadata, expected)
    return shard


def _entry(path: Path, shard: Shard) -> ShardEntry:
    with path.open("rb") as file:
        sha256 = hashlib.file_digest(file, "sha256").hexdigest()
    metadata = shard.metadata
    return ShardEntry(path.name, sha256, metadata.first, metadata.count, len(shard.t))


def _check_belongs(path: Path, found: ShardMetadata, expected: ShardMetadata) -> None:
    got, wanted = asdict(found), asdict(expected)
    differences = [f"{key} {got[key]!r} instead of {wanted[key]!r}" for key in got if got[key] != wanted[key]]
    if differences:
        raise DamagedFile(f"{path}: belongs to another dataset: {', '.join(differences)}")


def _check_complete(entries: Sequence[ShardEntry], trajectories: int) -> list[str]:
    owner: dict[int, str] = {}
    problems = []
    for entry in entries:
        for number in range(entry.first, entry.first + entry.count):
            if number in owner:
                problems.append(f"{entry.file}: trajectory {number} is also in {owner[number]}")
            elif number >= trajectories:
                problems.append(f"{entry.file}: trajectory {number} lies beyond the {trajectories} expected")
            owner.setdefault(number, entry.file)
    missing = [number for number in range(trajectories) if number not in owner]
    if missing:
        problems.append(f"no shard holds the trajectories {missing}")
    return problems
