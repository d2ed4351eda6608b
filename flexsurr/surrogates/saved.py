"""Whatever is learned, on disk: an .npz of arrays with a JSON header that says what they are."""

import json
import zipfile
from collections.abc import Callable, Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any, Literal, TypeVar

import numpy as np

from flexsurr.simulation.rhs import Model
from flexsurr.storage import DamagedFile, replacing
from flexsurr.surrogates.even_hnn import EvenHNN
from flexsurr.surrogates.hnn import HNN, DissipativeHNN
from flexsurr.surrogates.learned_map import Intervals, LearnedMap
from flexsurr.surrogates.mlp import MLP
from flexsurr.surrogates.network_map import NetworkMap
from flexsurr.surrogates.polynomial import PolynomialHamiltonian
from flexsurr.surrogates.polynomial_map import PolynomialMap
from flexsurr.surrogates.port_hamiltonian_network import NetworkPortHamiltonian
from flexsurr.surrogates.port_hamiltonian_polynomial import PolynomialPortHamiltonian
from flexsurr.surrogates.potential import Potential
from flexsurr.surrogates.scaling import FeatureScaling, PairScaling, Scaling, StateScaling
from flexsurr.surrogates.surrogate import Surrogate, compiled

Kept = TypeVar("Kept")


class SurrogateFileError(DamagedFile):
    """A file that cannot be read as a surrogate; the message names it."""


def write_archive(
    path: str | Path, form: str, header: Mapping[str, Any], arrays: Mapping[str, np.ndarray]
) -> None:
    """Write an .npz of `arrays`, its header {"format": form, **header}, whole or not at all."""
    text = np.array(json.dumps({"format": form, **header}))
    with replacing(Path(path)) as beside, beside.open("wb") as file:
        np.savez(file, allow_pickle=False, header=text, **arrays)


def read_archive(
    path: str | Path, form: str, what: str, build: Callable[[dict[str, Any], dict[str, Any]], Kept]
) -> Kept:
    """What `build(header, arrays)` makes of the file; arrays are integers, or contiguous finite float64.

    Raises SurrogateFileError for a damaged or foreign file, saying that it is not `what`; OSError for none.
    """
    arrays = _arrays(path)
    try:
        header = json.loads(str(arrays.pop("header")))
        if header["format"] != form:
            raise SurrogateFileError(f"{path}: format {header['format']!r}, expected {form!r}")
        return build(header, {name: _numbers(name, array) for name, array in arrays.items()})
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        detail = f"no {error}" if isinstance(error, KeyError) else error
        raise SurrogateFileError(f"{path}: not {what} of flexsurr ({detail})") from None


def form_of(path: str | Path) -> str:
    """What form of an archive a file is, "" where it has none.

    Raises SurrogateFileError for a file that is no .npz, OSError for none.
    """
    try:
        return str(json.loads(str(_arrays(path)["header"]))["format"])
    except (KeyError, TypeError, ValueError):
        return ""


def _arrays(path: str | Path) -> dict[str, np.ndarray]:
    try:
        with Path(path).open("rb") as content, np.load(content, allow_pickle=False) as file:
            return dict(file)
    except FileNotFoundError:
        raise
    except (OSError, EOFError, ValueError, TypeError, RuntimeError, zipfile.BadZipFile) as error:
        # NumPy's own words advise to load it as code
        reason = f" ({error.strerror})" if isinstance(error, OSError) and error.strerror else ""
        raise SurrogateFileError(f"{path}: not a readable .npz file{reason}") from None


def _numbers(name: str, array: np.ndarray) -> np.ndarray:
    if np.issubdtype(array.dtype, np.integer):
        return array
    numbers = np.ascontiguousarray(array, dtype=np.float64)
    if not np.all(np.isfinite(numbers)):
        raise ValueError(f"{name} that are not finite")
    return numbers


FORMAT = "flexsurr surrogate 1"
MAP_FORMAT = "flexsurr learned map 2"
NETWORKS = {network.architecture: network for network in (MLP, HNN, DissipativeHNN)}


def save(
    surrogate: Surrogate,
    path: str | Path,
    about: Mapping[str, Any] | None = None,
    about_arrays: Mapping[str, np.ndarray] | None = None,
) -> None:
    """Write `surrogate` to `path` whole: beside its place first, then moved there.

    What it stands for is said by `about`, plain JSON values, and `about_arrays`; `load_about` reads them.
    """
    header = {
        "architecture": surrogate.architecture,
        "state_names": surrogate.state_names,
        "state_units": surrogate.state_units,
        "scaling": asdict(surrogate.scaling),
        **surrogate.settings(),
    }
    if about is not None:
        header["about"] = dict(about)
    write_archive(path, FORMAT, header, surrogate.arrays_to_keep() | dict(about_arrays or {}))


def load(path: str | Path) -> Surrogate:
    """The surrogate in `path`. Raises SurrogateFileError for a damaged or foreign file, OSError for none.

    A network of the user's own runs its file, which lies below the current folder; ConfigurationError says
    where it is missing, or is not the one that the surrogate was trained with.
    """
    return read_archive(path, FORMAT, "a surrogate", _surrogate)


def load_about(
    path: str | Path, build: Callable[[Surrogate, dict[str, Any], dict[str, np.ndarray]], Kept]
) -> Kept:
    """What `build(surrogate, about, arrays)` makes of the surrogate in `path` and of what was saved about it.

    Raises as `load`, and SurrogateFileError where nothing was.
    """
    return read_archive(
        path,
        FORMAT,
        "a surrogate that knows what it stands for",
        lambda header, arrays: build(_surrogate(header, arrays), header["about"], arrays),
    )


def _surrogate(header: dict[str, Any], arrays: dict[str, np.ndarray]) -> Surrogate:
    common: dict[str, Any] = {
        "scaling": _scaling(header["scaling"]),
        "state_names": tuple(header["state_names"]),
        "state_units": tuple(header["state_units"]),
    }
    architecture = header["architecture"]
    if architecture == "torch":
        # torch takes seconds to import, and no other surrogate needs it
        from flexsurr.surrogates.torch_surrogate import saved_torch_surrogate

        return saved_torch_surrogate(header, arrays, **common)
    common["parameters"] = arrays["parameters"]
    polynomials: dict[str, Callable[..., Surrogate]] = {
        PolynomialHamiltonian.architecture: PolynomialHamiltonian,
        PolynomialPortHamiltonian.architecture: PolynomialPortHamiltonian,
    }
    polynomial = polynomials.get(architecture)
    if architecture == PolynomialPortHamiltonian.architecture:
        common["potential"] = Potential.kept(arrays)
    if polynomial is not None and "hidden" not in header:
        return polynomial(**common, exponents=arrays["exponents"].astype(np.int64, casting="safe"))
    common |= {"hidden": tuple(header["hidden"]), "activation": header["activation"]}
    if architecture == NetworkPortHamiltonian.architecture:
        common["potential"] = Potential.kept(arrays)
        common |= {key: bool(header[key]) for key in ("even", "factored") if key in header}
        common["mirrors"] = arrays.get("mirrors")
        return NetworkPortHamiltonian(**common, floor=arrays["floor"])
    if architecture == EvenHNN.architecture:
        return EvenHNN(**common)
    return NETWORKS[architecture](**common)


def _scaling(values: dict[str, Any]) -> StateScaling:
    if "action" in values:
        return PairScaling(q=tuple(values["q"]), action=values["action"], energy=values["energy"])
    if "dx" in values:
        x_from, dx_from = (each and tuple(each) for each in (values["x_from"], values["dx_from"]))
        return FeatureScaling(tuple(values["x"]), tuple(values["dx"]), x_from, dx_from)
    return Scaling(**values)


def load_model(path: str | Path, implementation: Literal["numpy", "compiled"]) -> Model:
    """The surrogate in `path` as a model in plain NumPy or compiled."""
    surrogate = load(path)
    if implementation == "numpy":
        return surrogate
    if implementation == "compiled":
        return compiled(surrogate)
    raise ValueError(f"implementation {implementation!r} is not one of numpy, compiled")


def save_map(learned: LearnedMap, path: str | Path) -> None:
    """Write `learned` to `path` (.npz) whole: beside its place first, then moved there."""
    names = {"input_names": learned.inputs.names, "output_names": learned.output_names}
    intervals = {"input_low": learned.inputs.low, "input_high": learned.inputs.high}
    header = {"kind": learned.kind, **names, **learned.settings()}
    write_archive(path, MAP_FORMAT, header, learned.arrays() | intervals)


def load_map(path: str | Path) -> LearnedMap:
    """The map in `path`. Raises SurrogateFileError for a damaged or foreign file, OSError for none."""
    return read_archive(path, MAP_FORMAT, "a learned map", _map)


def _map(header: dict[str, Any], arrays: dict[str, np.ndarray]) -> LearnedMap:
    inputs = Intervals(tuple(header["input_names"]), arrays["input_low"], arrays["input_high"])
    names = tuple(header["output_names"])
    if header["kind"] == PolynomialMap.kind:
        exponents = arrays["exponents"].astype(np.int64, casting="safe")
        return PolynomialMap(inputs, names, exponents, arrays["coefficients"])
    if header["kind"] != NetworkMap.kind:
        raise ValueError(f"of the kind {header['kind']!r}")
    return NetworkMap(
        inputs,
        Intervals(names, arrays["output_low"], arrays["output_high"]),
        header["hidden"],
        header["activation"],
        arrays["parameters"],
        tuple((first, second) for first, second in header["products"]),
    )
