"""A user's files as a shard: forces leave the derivatives, and a file that changes meanwhile is refused."""

import hashlib

import numpy as np
import pandas as pd
import pytest

from flexsurr.cli.datasets import ingest
from flexsurr.storage import StorageError, read_shard

T = np.linspace(0.0, 1.0, 30)


@pytest.fixture
def job(tmp_path, monkeypatch):
    """ṗ = −2 q + u, of which q, p, their derivatives and u are recorded."""
    monkeypatch.chdir(tmp_path)
    q, p = np.sin(2.0 * T), np.cos(2.0 * T)
    columns = {"t": T, "q": q, "p": p, "dq": 2.0 * p, "dp": -2.0 * q + T, "push": T}
    pd.DataFrame(columns).to_csv("a.csv", index=False)
    return {
        "study": "spring",
        "variant": "files",
        "seed": 1,
        "configuration": "c0ffee",
        "files": {"a.csv": hashlib.sha256((tmp_path / "a.csv").read_bytes()).hexdigest()},
        "columns": {
            "pairs": [
                {
                    "q": {"column": "q", "unit": "m", "derivative": "dq"},
                    "p": {"column": "p", "unit": "N s", "derivative": "dp"},
                    "force": {"column": "push", "unit": "N"},
                }
            ]
        },
        "filter": None,
    }


def test_what_the_states_do_by_themselves_is_learned_and_forces_are_kept(job, tmp_path):
    ingest(job, tmp_path / "shard-0000.parquet")
    shard = read_shard(tmp_path / "shard-0000.parquet")
    np.testing.assert_allclose(
        shard.dx, np.column_stack([2.0 * shard.x[:, 1], -2.0 * shard.x[:, 0]]), atol=1e-12
    )
    np.testing.assert_allclose(shard.inputs, T[:, None])
    assert (shard.metadata.input_names, shard.metadata.input_units) == (("force_on_p",), ("N",))


def test_estimated_derivatives_lose_the_forces_too(job, tmp_path):
    for state in job["columns"]["pairs"][0].values():
        state.pop("derivative", None)
    job["filter"] = {"window": 7, "order": 4}
    ingest(job, tmp_path / "shard-0000.parquet")
    shard = read_shard(tmp_path / "shard-0000.parquet")
    # q and p are those of the free spring here, so that estimated slopes are known
    expected = np.column_stack([2.0 * np.cos(2.0 * T), -2.0 * np.sin(2.0 * T) - T])
    np.testing.assert_allclose(shard.dx, expected, atol=1e-3)


def test_a_file_that_has_changed_since_is_named(job, tmp_path):
    with (tmp_path / "a.csv").open("a") as file:
        file.write("1.1,0,0,0,0,0\n")
    with pytest.raises(StorageError, match=r"a\.csv: has changed"):
        ingest(job, tmp_path / "shard-0000.parquet")
