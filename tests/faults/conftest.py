"""Small results, in which tests damage one file at a time."""

import shutil

import pytest
from small_results import OTHER, RUN, Results


@pytest.fixture(scope="session")
def whole(tmp_path_factory) -> Results:
    """Read only: tests that damage something take a copy."""
    results = Results(tmp_path_factory.mktemp("results"))
    for shard in (0, 1):
        results.simulate(shard)
    results.manifest()
    for key in (RUN, OTHER):
        results.train(key)
        results.score(key)
    results.select()
    results.statics()
    results.tabulate("static_tip")
    return results


@pytest.fixture
def results(whole, tmp_path) -> Results:
    """A copy that may be damaged."""
    return Results(shutil.copytree(whole.root, tmp_path / "results"))
