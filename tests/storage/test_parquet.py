from dataclasses import replace

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from flexsurr.storage import (
    Shard,
    ShardMetadata,
    StorageError,
    read_shard,
    replacing,
    write_json,
    write_shard,
)

FINITE = st.floats(allow_nan=False, allow_infinity=False)
IN_A_FOLDER = settings(max_examples=30, suppress_health_check=[HealthCheck.function_scoped_fixture])


@st.composite
def shards(draw):
    lengths = draw(st.lists(st.integers(1, 5), min_size=1, max_size=4))
    dimension, rows, first = draw(st.integers(1, 4)), sum(lengths), draw(st.integers(0, 10**9))
    metadata = ShardMetadata(
        study=draw(st.text(max_size=5)),
        variant=draw(st.text(max_size=5)),
        seed=draw(st.integers(0, 2**63)),
        configuration=draw(st.text(max_size=5)),
        first=first,
        count=len(lengths),
        state_names=tuple(f"x_{i}" for i in range(dimension)),
        state_units=tuple(draw(st.text(max_size=3)) for _ in range(dimension)),
        failures=tuple(draw(st.lists(st.text(max_size=5), max_size=2))),
    )
    return Shard(
        trajectory=np.repeat(np.arange(first, first + len(lengths)), lengths),
        t=draw(arrays(np.float64, rows, elements=FINITE)),
        x=draw(arrays(np.float64, (rows, dimension), elements=FINITE)),
        dx=draw(arrays(np.float64, (rows, dimension), elements=FINITE)),
        metadata=metadata,
    )


def same(a: Shard, b: Shard) -> bool:
    columns = ("trajectory", "t", "x", "dx")
    return a.metadata == b.metadata and all(
        np.array_equal(getattr(a, name), getattr(b, name)) for name in columns
    )


@IN_A_FOLDER
@given(shard=shards())
def test_what_is_written_is_read_to_the_last_bit(tmp_path, shard):
    path = tmp_path / "shard.parquet"
    write_shard(path, shard)
    assert same(read_shard(path), shard)


@IN_A_FOLDER
@given(data=st.data())
def test_a_damaged_file_is_named_or_reads_as_it_was(tmp_path, make_shard, data):
    """A flipped bit may fall into padding, but it never changes what is read."""
    path, shard = tmp_path / "shard.parquet", make_shard(0, 2)
    write_shard(path, shard)
    content = bytearray(path.read_bytes())
    position = data.draw(st.integers(0, len(content) - 1))
    content[position] ^= 1 << data.draw(st.integers(0, 7))
    path.write_bytes(content)
    try:
        found = read_shard(path)
    except StorageError as error:
        message = str(error)
    else:
        message = str(path)
        np.testing.assert_array_equal(found.x, shard.x)
        np.testing.assert_array_equal(found.dx, shard.dx)
        np.testing.assert_array_equal(found.t, shard.t)
    assert str(path) in message


@pytest.mark.parametrize("part", [0.0, 0.3, 0.9, 0.999])
def test_a_truncated_file_is_named(tmp_path, make_shard, part):
    path = tmp_path / "shard.parquet"
    write_shard(path, make_shard(0, 2))
    content = path.read_bytes()
    path.write_bytes(content[: int(part * len(content))])
    with pytest.raises(StorageError, match=r"shard\.parquet: damaged or truncated"):
        read_shard(path)


def test_a_missing_file_is_named(tmp_path):
    with pytest.raises(StorageError, match=r"absent\.parquet: cannot be read"):
        read_shard(tmp_path / "absent.parquet")


def test_a_foreign_parquet_file_is_named(tmp_path):
    path = tmp_path / "foreign.parquet"
    pq.write_table(pa.table({"trajectory": [0], "t": [0.0]}), path)
    with pytest.raises(StorageError, match=r"foreign\.parquet: a foreign Parquet file"):
        read_shard(path)


def test_another_format_version_is_refused(tmp_path, make_shard):
    path = tmp_path / "shard.parquet"
    write_shard(path, make_shard(0, 2, format_version=99))
    with pytest.raises(StorageError, match=r"shard\.parquet: has format version 99"):
        read_shard(path)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda s: replace(s, x=np.where(s.x == s.x[3, 1], np.nan, s.x)), "not finite"),
        (lambda s: replace(s, dx=np.where(s.dx == s.dx[0, 0], np.inf, s.dx)), "not finite"),
        (lambda s: replace(s, trajectory=s.trajectory[::-1].copy()), "out of order"),
        (lambda s: replace(s, trajectory=s.trajectory + 5), "expected"),
        (lambda s: replace(s, t=s.t[1:]), "different lengths"),
        (lambda s: replace(s, x=s.x.astype(np.float32)), "float32"),
        (lambda s: replace(s, metadata=replace(s.metadata, state_units=("rad",))), "2 states and 1 units"),
    ],
)
def test_a_shard_that_contradicts_itself_is_not_written(tmp_path, make_shard, change, message):
    path = tmp_path / "shard.parquet"
    with pytest.raises(ValueError, match=message):
        write_shard(path, change(make_shard(0, 2)))
    assert list(tmp_path.iterdir()) == []


def test_an_interrupted_write_leaves_the_old_file_and_nothing_else(tmp_path):
    path = tmp_path / "file.json"
    write_json(path, {"old": 1})
    before = path.read_bytes()

    def interrupted() -> None:
        with replacing(path) as beside:
            beside.write_text("half")
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        interrupted()
    assert path.read_bytes() == before
    assert list(tmp_path.iterdir()) == [path]


def test_json_refuses_what_is_not_a_number(tmp_path):
    with pytest.raises(ValueError, match="not JSON compliant"):
        write_json(tmp_path / "file.json", {"loss": float("nan")})
    assert list(tmp_path.iterdir()) == []
