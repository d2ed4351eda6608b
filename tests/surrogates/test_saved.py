"""Saved surrogates come back as they were; anything else is refused in a line that names the file."""

import json

import numpy as np
import pytest
from random_surrogates import HAMILTONIANS, PORT_HAMILTONIANS, network

from flexsurr.surrogates import (
    MLP,
    CompiledSurrogate,
    DissipativeHNN,
    SurrogateFileError,
    load,
    load_model,
    save,
)

KINDS = [
    *HAMILTONIANS.values(),
    *PORT_HAMILTONIANS.values(),
    network(MLP, 4, (5, 3), "silu"),
    network(DissipativeHNN, 4, (5, 3), "silu"),
]


@pytest.mark.parametrize("surrogate", KINDS)
def test_round_trip(surrogate, tmp_path):
    path = tmp_path / "weights.npz"
    save(surrogate, path)
    loaded = load(path)
    assert type(loaded) is type(surrogate)
    assert (loaded.scaling, loaded.state_names, loaded.state_units) == (
        surrogate.scaling,
        surrogate.state_names,
        surrogate.state_units,
    )
    x = np.random.default_rng(0).normal(size=(5, len(surrogate.state_names)))
    np.testing.assert_array_equal(loaded.derivative(0.0, x), surrogate.derivative(0.0, x))
    assert [file.name for file in tmp_path.iterdir()] == ["weights.npz"]


def test_models_by_implementation(tmp_path):
    surrogate = HAMILTONIANS["one layer"]
    save(surrogate, tmp_path / "weights.npz")
    assert isinstance(load_model(tmp_path / "weights.npz", "numpy"), type(surrogate))
    assert isinstance(load_model(tmp_path / "weights.npz", "compiled"), CompiledSurrogate)
    with pytest.raises(ValueError, match="not one of numpy, compiled"):
        load_model(tmp_path / "weights.npz", "fortran")


def test_no_cut_of_a_file_is_read(tmp_path):
    path = tmp_path / "weights.npz"
    save(HAMILTONIANS["even"], path)
    content = path.read_bytes()
    for size in range(0, len(content), 37):
        path.write_bytes(content[:size])
        with pytest.raises(SurrogateFileError, match=r"weights\.npz: "):
            load(path)


def test_flipped_bits_are_noticed(tmp_path):
    path = tmp_path / "weights.npz"
    save(HAMILTONIANS["one layer"], path)
    content = bytearray(path.read_bytes())
    place = content.find(HAMILTONIANS["one layer"].parameters.tobytes())
    content[place + 5] ^= 0x10
    path.write_bytes(content)
    with pytest.raises(SurrogateFileError, match=r"weights\.npz: "):
        load(path)


def rewritten(path, **changes):
    """The saved file with entries of its header or arrays changed; None leaves one out."""
    with np.load(path) as file:
        arrays = dict(file)
    header = json.loads(str(arrays["header"]))
    for key, value in changes.items():
        target = arrays if key in ("parameters", "exponents") else header
        if value is None:
            del target[key]
        else:
            target[key] = value
    np.savez(path, **arrays | {"header": np.array(json.dumps(header))})


@pytest.mark.parametrize(
    ("changes", "reason"),
    [
        ({"format": "someone else's"}, "format"),
        ({"architecture": "gnn"}, "gnn"),
        ({"activation": "relu"}, "relu"),
        ({"activation": None}, "activation"),
        ({"hidden": [9, 9]}, "parameters"),
        ({"hidden": "wide"}, "not a surrogate"),
        ({"scaling": {"q": 0.0, "p": 1.0, "energy": 1.0}}, "scale of q"),
        ({"parameters": np.full(36, np.nan)}, "not finite"),
        ({"parameters": None}, "parameters"),
        ({"parameters": np.array(["x"] * 36)}, "not a surrogate"),
    ],
)
def test_foreign_contents_are_refused(changes, reason, tmp_path):
    path = tmp_path / "weights.npz"
    save(HAMILTONIANS["one layer"], path)
    rewritten(path, **changes)
    with pytest.raises(SurrogateFileError, match=reason) as caught:
        load(path)
    assert "\n" not in str(caught.value)


def test_files_of_other_programs_are_refused(tmp_path):
    path = tmp_path / "weights.npz"
    np.savez(path, a=np.arange(3))
    with pytest.raises(SurrogateFileError, match="header"):
        load(path)
    np.save(tmp_path / "weights.npy", np.arange(3))
    for name, content in (("weights.npy", None), ("text", b"learning_rate: 1\n")):
        if content is not None:
            (tmp_path / name).write_bytes(content)
        with pytest.raises(SurrogateFileError, match=name):
            load(tmp_path / name)


def test_objects_are_never_unpickled(tmp_path):
    path = tmp_path / "weights.npz"
    np.savez(path, header=np.array([{}], dtype=object))
    with pytest.raises(SurrogateFileError):
        load(path)


def test_a_missing_file_is_missing(tmp_path):
    with pytest.raises(FileNotFoundError):
        load(tmp_path / "weights.npz")
