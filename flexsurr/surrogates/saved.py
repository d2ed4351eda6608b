"""Surrogates and maps on disk: one .npz of arrays with a JSON header that says what they are."""

from collections.abc import Callable, Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any, Literal

import numpy as np

from flexsurr.simulation.rhs import Model
from flexsurr.surrogates.archive import Kept, read_archive, write_archive
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
        given = {key: bool(header[key]) for key in ("even", "factored") if key in header}
        return NetworkPortHamiltonian(**common, floor=arrays["floor"], **given)
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
