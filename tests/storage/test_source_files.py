"""A user's own files: three kinds hold the same; whatever is no trajectory is refused in one line."""

import numpy as np
import pandas as pd
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.signal import savgol_filter

from flexsurr.config.files import Columns, Filter
from flexsurr.storage import StorageError
from flexsurr.storage.source_files import filtered, find_files, read_recordings, savitzky_golay

Q, P = {"column": "theta", "unit": "rad"}, {"column": "L", "unit": "kg m^2/s"}
COLUMNS = {"t": "time", "trajectory": "run", "pairs": [{"q": Q, "p": P}]}
GIVEN = [{"q": Q | {"derivative": "rate"}, "p": P | {"derivative": "torque"}}]
FILTER = Filter(window=5, order=2)


def table(runs=(1, 2), samples=6) -> pd.DataFrame:
    t = np.tile(np.linspace(0.0, 0.5, samples), len(runs))
    x = np.random.default_rng(0).normal(size=(len(t), 4))
    columns = {"theta": x[:, 0], "L": x[:, 1], "rate": x[:, 2], "torque": x[:, 3]}
    return pd.DataFrame({"time": t, "run": np.repeat(runs, samples), **columns, "note": "x"})


def write(path, frame):
    if path.suffix == ".npz":
        np.savez(path, **{name: frame[name].to_numpy() for name in frame if name != "note"})
    elif path.suffix == ".csv":
        frame.to_csv(path, index=False)
    else:
        frame.to_parquet(path, index=False)


def read(folder, *files, least=FILTER.window, **changes):
    return read_recordings(folder, files, Columns.model_validate(COLUMNS | changes), least)


@pytest.mark.parametrize("kind", ["csv", "parquet", "npz"])
def test_every_kind_of_file_holds_the_same_trajectories(tmp_path, kind):
    frame = table()
    write(tmp_path / f"a.{kind}", frame)
    found = read(tmp_path, f"a.{kind}", pairs=GIVEN)
    assert len(found.trajectories) == 2
    for run, recording in zip((1, 2), found.trajectories, strict=True):
        rows = frame[frame["run"] == run]
        np.testing.assert_array_equal(recording.t, rows["time"])
        np.testing.assert_array_equal(recording.x, rows[["theta", "L"]])
        np.testing.assert_array_equal(recording.dx, rows[["rate", "torque"]])


def test_rows_of_trajectories_may_be_mixed_and_names_may_be_words(tmp_path):
    frame = table(runs=("up", "down"))
    write(tmp_path / "a.csv", frame.sort_values("time", kind="stable"))
    write(tmp_path / "b.csv", frame)
    mixed, apart = read(tmp_path, "a.csv").trajectories, read(tmp_path, "b.csv").trajectories
    for one, other in zip(mixed, apart, strict=True):
        np.testing.assert_array_equal(one.x, other.x)


def test_without_a_trajectory_column_each_file_is_one(tmp_path):
    for name in ("b", "a"):
        write(tmp_path / f"{name}.csv", table(runs=(1,)))
    files = find_files(tmp_path, ["*.csv", "a.csv"])
    assert files == ["a.csv", "b.csv"]
    assert [found.file for found in read(tmp_path, *files, trajectory=None).trajectories] == files


def with_one(name, row, value):
    """A change of one value of a table, in the row of that number."""
    return lambda f: f.assign(**{name: f[name].astype(object).where(f.index != row - 1, value)})


BAD = [
    (lambda f: f.drop(columns="L"), ["no column L", "there are: time, run, theta, rate"]),
    (lambda f: f.drop(index=range(1, 6)), ["1 samples of trajectory 1", "at least 5"]),
    (with_one("time", 4, 0.1), ["row 4 of trajectory 1", "time is 0.1 after 0.2"]),
    (with_one("L", 8, np.nan), ["row 8", "L is nan", "finite"]),
    (with_one("theta", 3, np.inf), ["row 3", "theta is inf"]),
    (with_one("L", 6, "-"), ["row 6", "L is '-'"]),
    (with_one("run", 1, None), ["row 1", "run is missing"]),
]


@pytest.mark.parametrize(("change", "words"), BAD)
def test_what_is_no_trajectory_is_refused_with_file_column_and_row(tmp_path, change, words):
    write(tmp_path / "a.csv", change(table()))
    with pytest.raises(StorageError) as refused:
        read(tmp_path, "a.csv")
    assert len(str(refused.value).splitlines()) == 1
    for word in ["a.csv", *words]:
        assert word in str(refused.value)


def test_each_bad_file_has_its_line(tmp_path):
    (tmp_path / "a.npz").write_bytes(b"no archive")
    (tmp_path / "b.parquet").write_bytes(b"PAR1")
    (tmp_path / "c.txt").write_text("t q p")
    np.savez(tmp_path / "d.npz", time=np.zeros(4), run=np.zeros(4), theta=np.zeros((4, 2)), L=np.zeros(4))
    np.savez(tmp_path / "e.npz", time=np.zeros(4), run=np.zeros(4), theta=np.zeros(4), L=np.zeros(3))
    (tmp_path / "f.csv").write_text("")
    files = ["a.npz", "b.parquet", "c.txt", "d.npz", "e.npz", "f.csv", "g.csv"]
    with pytest.raises(StorageError) as refused:
        read(tmp_path, *files)
    lines = str(refused.value).splitlines()
    assert [line.split(":")[0] for line in lines] == files
    assert "theta is of shape (4, 2)" in lines[3]
    assert "L has 3 values, time 4" in lines[4]


def test_a_pattern_that_no_file_fits_is_named(tmp_path):
    with pytest.raises(StorageError, match=r"measured/\*\.csv: no such file"):
        find_files(tmp_path, ["measured/*.csv"])


@given(
    samples=st.integers(9, 40), half=st.integers(1, 4), order=st.integers(1, 4), seed=st.integers(0, 2**32)
)
def test_on_even_samples_the_filter_is_scipys(samples, half, order, seed):
    window, step = 2 * half + 1, 0.05
    if window <= order:
        return
    x = np.random.default_rng(seed).normal(size=(samples, 2))
    value, slope = savitzky_golay(step * np.arange(samples), x, window, order)
    for found, derivative in ((value, 0), (slope, 1)):
        expected = savgol_filter(x, window, order, deriv=derivative, delta=step, axis=0, mode="interp")
        np.testing.assert_allclose(found, expected, rtol=0.0, atol=1e-8 * np.abs(expected).max())


@given(order=st.integers(1, 4), seed=st.integers(0, 2**32))
def test_polynomials_pass_the_filter_unchanged_however_samples_are_spaced(order, seed):
    generator = np.random.default_rng(seed)
    t = np.cumsum(generator.uniform(0.5, 1.5, size=15)) + 100.0
    polynomial = np.polynomial.Polynomial(generator.normal(size=order + 1), domain=[t[0], t[-1]])
    value, slope = savitzky_golay(t, polynomial(t)[:, None], 7, order)
    np.testing.assert_allclose(value[:, 0], polynomial(t), rtol=0.0, atol=1e-9)
    np.testing.assert_allclose(slope[:, 0], polynomial.deriv()(t), rtol=0.0, atol=1e-9)


def test_forces_are_read_where_they_act_and_are_zero_elsewhere(tmp_path):
    frame = table().assign(push=lambda f: f["time"] ** 2)
    write(tmp_path / "a.csv", frame)
    force = {"force": {"column": "push", "unit": "N m"}}
    other = {"q": {"column": "rate", "unit": "m"}, "p": {"column": "torque", "unit": "kg m/s"}}
    found = read(tmp_path, "a.csv", pairs=[{"q": Q, "p": P, **force}, other]).trajectories[1]
    assert found.u is not None
    np.testing.assert_allclose(found.u, np.column_stack([frame["push"][6:], np.zeros(6)]))


def test_derivatives_that_are_there_are_kept_and_others_estimated(tmp_path):
    write(tmp_path / "a.csv", table())
    given_ones = read(tmp_path, "a.csv", pairs=GIVEN).trajectories[0]
    missing = read(tmp_path, "a.csv").trajectories[0]
    smooth, slope = savitzky_golay(missing.t, missing.x, 5, 2)
    as_it_is = FILTER.model_copy(update={"smooth_states": False})
    np.testing.assert_array_equal(filtered(given_ones, FILTER).dx, given_ones.dx)
    np.testing.assert_array_equal(filtered(missing, FILTER).dx, slope)
    for recording in (given_ones, missing):
        np.testing.assert_array_equal(filtered(recording, FILTER).x, smooth)
        np.testing.assert_array_equal(filtered(recording, as_it_is).x, recording.x)
