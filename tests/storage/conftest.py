from pathlib import Path

import numpy as np
import pytest

from flexsurr.storage import Shard, ShardMetadata, write_shard

DATASET = {"study": "beam", "variant": "hamiltonian", "seed": 7, "configuration": "c0ffee"}
STATES = {"state_names": ("eta_1", "p_1"), "state_units": ("rad", "kg m2/s")}


@pytest.fixture
def make_shard():
    """A shard of `count` trajectories from number `first`; each number seeds its own."""

    def make(first: int, count: int, samples: int = 4, **changes) -> Shard:
        x = np.concatenate(
            [np.random.default_rng(k).normal(size=(samples, 2)) for k in range(first, first + count)]
        )
        return Shard(
            trajectory=np.repeat(np.arange(first, first + count), samples),
            t=np.tile(np.linspace(0.0, 0.1, samples), count),
            x=x,
            dx=np.cos(x),
            metadata=ShardMetadata(**{**DATASET, **STATES, "first": first, "count": count, **changes}),
        )

    return make


@pytest.fixture
def dataset(tmp_path: Path, make_shard) -> list[Path]:
    """Three shards of two trajectories each."""
    paths = [tmp_path / f"shard-{number:04d}.parquet" for number in range(3)]
    for number, path in enumerate(paths):
        write_shard(path, make_shard(2 * number, 2))
    return paths
