"""Batches: many trials in few jobs, and a batch that stays what it is while its sweep grows."""

import json

import pytest

from flexsurr.workflow.batches import (
    JOBS,
    MANY,
    batch_of_shard,
    batches_of_runs,
    number_of_batches,
    outdated,
    shards_of_batch,
)


def keys(count: int) -> list[str]:
    return [f"hnn-{number * 7919:010x}" for number in range(count)]


@pytest.mark.parametrize("total", [1, MANY])
def test_few_have_a_job_each(total):
    assert batches_of_runs(keys(total), None) == {}
    assert batch_of_shard(0, total, None) is None


@pytest.mark.parametrize("per_job", [None, 2])
@pytest.mark.parametrize("total", [MANY + 1, 10_000])
def test_many_make_a_number_of_jobs_that_does_not_grow(total, per_job):
    assert number_of_batches(total, per_job) == JOBS
    assert len(batches_of_runs(keys(total), per_job)) <= JOBS


@pytest.mark.parametrize("per_job", [None, 1])
def test_one_per_job_means_no_batches(per_job):
    assert batches_of_runs(keys(20), per_job) == {}


@pytest.mark.parametrize(("total", "per_job"), [(7, 3), (300, 20), (1_000, None)])
def test_each_is_in_one_batch(total, per_job):
    runs = [key for batch in batches_of_runs(keys(total), per_job).values() for key in batch]
    assert sorted(runs) == sorted(keys(total))
    for shard in range(total):
        assert shard in shards_of_batch(batch_of_shard(shard, total, per_job), total)


def test_a_new_trial_changes_its_own_batch_alone():
    before, after = batches_of_runs(keys(500), None), batches_of_runs(keys(501), None)
    changed = [name for name in after if after[name] != before.get(name)]
    assert len(changed) == 1
    assert keys(501)[-1] in after[changed[0]]


def test_no_batch_of_shards_is_much_larger_than_asked_for():
    for total in (5, 64, 65, 500):
        for shard in range(total):
            assert len(shards_of_batch(batch_of_shard(shard, total, 4), total)) <= 4


def test_a_note_of_a_batch_is_outdated_once_a_file_that_it_tells_of_is_gone(tmp_path):
    notes = {
        "batches/beam/trials-0-of-2.json": ["runs/a/metrics.json", "runs/b/metrics.json"],
        "datasets/beam/hamiltonian/shards-0-of-1.json": ["datasets/beam/hamiltonian/shard-0000.parquet"],
    }
    for note, files in notes.items():
        for file in (note, *files):
            (tmp_path / file).parent.mkdir(parents=True, exist_ok=True)
            (tmp_path / file).touch()
        (tmp_path / note).write_text(json.dumps({"made": files}))
    assert list(outdated(tmp_path)) == []
    (tmp_path / "runs/b/metrics.json").unlink()
    assert list(outdated(tmp_path)) == [tmp_path / "batches/beam/trials-0-of-2.json"]
    (tmp_path / "datasets/beam/hamiltonian/shards-0-of-1.json").write_text('{"ma')
    assert set(outdated(tmp_path)) == {tmp_path / note for note in notes}
    assert list(outdated(tmp_path / "nowhere")) == []
