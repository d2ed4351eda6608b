"""Learned maps of the coordinates η: to positions and directions, or to generalised forces.

The Jacobian of learned positions gives generalised forces, Q = (∂r̂/∂η)ᵀ F, which do the work of F along
them exactly; the same map gives the outputs.
"""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, ClassVar, NamedTuple

import numpy as np

from flexsurr.simulation.rhs import Array
from flexsurr.surrogates.activations import ACTIVATIONS
from flexsurr.surrogates.archive import read_archive, write_archive
from flexsurr.surrogates.map_kernels import NetworkMapKernel, PolynomialMapKernel
from flexsurr.surrogates.monomials import Exponents, differentiate, evaluate_monomials, factors

FORMAT = "flexsurr learned map 1"


@dataclass(frozen=True, eq=False)
class LearnedMap(ABC):
    """`output_names` in their order; a subclass maps η over `scales` (r,), the reach of each coordinate."""

    scales: Array
    output_names: tuple[str, ...]

    kind: ClassVar[str]

    @abstractmethod
    def __call__(self, eta: Array) -> Array:
        """Outputs at coordinates, (..., r) -> (..., m)."""

    @abstractmethod
    def jacobian(self, eta: Array) -> Array:
        """∂(outputs)/∂η, (..., r) -> (..., m, r)."""

    @property
    @abstractmethod
    def form(self) -> str:
        """What it is made of, in two words."""

    @property
    @abstractmethod
    def parameter_count(self) -> int:
        """Numbers that were fitted."""

    @abstractmethod
    def kernel(self) -> tuple[NamedTuple, int]:
        """Compiled form (`map_kernels`) and the size of its workspace."""

    @abstractmethod
    def arrays(self) -> dict[str, np.ndarray]:
        """What makes this map, by the names of its attributes."""

    def generalised_force(self, eta: Array, force: Array) -> Array:
        """Q = (∂r̂/∂η)ᵀ F, (..., r), for forces (m,) or (..., m) on the outputs."""
        weighted: Array = np.einsum("...mk,...m->...k", self.jacobian(eta), force)
        return weighted

    def _check_outputs(self, count: int) -> None:
        if count != len(self.output_names):
            raise ValueError(f"{count} outputs do not fit the names {self.output_names}")
        if self.scales.ndim != 1 or not np.all(self.scales > 0.0):
            raise ValueError(f"the scales of the coordinates must be positive, not {self.scales}")


@dataclass(frozen=True, eq=False)
class PolynomialMap(LearnedMap):
    """Σ_k c_k φ_k(η / scales): `exponents` (count, r), the constant first; `coefficients` (count, m)."""

    exponents: Exponents
    coefficients: Array

    kind: ClassVar[str] = "polynomial"

    def __post_init__(self) -> None:
        factors(self.exponents)
        if len(self.coefficients) != len(self.exponents) or self.exponents.shape[1] != self.scales.size:
            raise ValueError("a coefficient for each monomial, and an exponent for each coordinate")
        self._check_outputs(self.coefficients.shape[1])

    def __call__(self, eta: Array) -> Array:
        """Outputs at coordinates, (..., r) -> (..., m)."""
        return evaluate_monomials(self.exponents, eta / self.scales) @ self.coefficients

    @cached_property
    def _derivative(self) -> tuple[Exponents, Array]:
        lowered, tensor = differentiate(self.exponents)
        return lowered, np.einsum("kli,im->lmk", tensor, self.coefficients) / self.scales

    def jacobian(self, eta: Array) -> Array:
        """∂(outputs)/∂η, (..., r) -> (..., m, r)."""
        lowered, coefficients = self._derivative
        monomials = evaluate_monomials(lowered, eta / self.scales)
        slopes: Array = np.einsum("...l,lmk->...mk", monomials, coefficients)
        return slopes

    @property
    def form(self) -> str:
        """Its degree."""
        powers = self.exponents.sum(axis=1)
        return f"degree {powers.max()}{'' if np.any(powers % 2) else ', even'}"

    @property
    def parameter_count(self) -> int:
        """Coefficients of all outputs."""
        return self.coefficients.size

    def kernel(self) -> tuple[NamedTuple, int]:
        """Monomials as products, then a sum for each output."""
        parents, of_factors = factors(self.exponents)
        kernel = PolynomialMapKernel(
            1.0 / self.scales,
            parents.astype(np.uint64),
            of_factors.astype(np.uint64),
            np.ascontiguousarray(self.coefficients.T).ravel(),
        )
        r = self.scales.size
        return kernel, r * (r + 3) // 2 + len(self.exponents)

    def arrays(self) -> dict[str, np.ndarray]:
        """What makes this map."""
        return {
            "scales": self.scales,
            "exponents": self.exponents,
            "coefficients": self.coefficients,
        }


@dataclass(frozen=True, eq=False)
class NetworkMap(LearnedMap):
    """W₂ᵀ σ(W₁ᵀ η / scales + b₁) + b₂: weights (r, n), biases (n,), readout (n, m), constant (m,)."""

    activation: str
    weights: Array
    biases: Array
    readout: Array
    constant: Array

    kind: ClassVar[str] = "network"

    def __post_init__(self) -> None:
        if self.activation not in ACTIVATIONS:
            raise ValueError(f"activation {self.activation!r} is not one of {', '.join(ACTIVATIONS)}")
        n = self.biases.size
        shapes = self.weights.shape, self.readout.shape, self.constant.shape
        if shapes != ((self.scales.size, n), (n, self.constant.size), (self.constant.size,)):
            raise ValueError(f"weights of shapes {shapes} do not fit {n} neurons")
        self._check_outputs(self.constant.size)

    def __call__(self, eta: Array) -> Array:
        """Outputs at coordinates, (..., r) -> (..., m)."""
        z = eta / self.scales @ self.weights + self.biases
        return ACTIVATIONS[self.activation].value(z) @ self.readout + self.constant

    def jacobian(self, eta: Array) -> Array:
        """∂(outputs)/∂η, (..., r) -> (..., m, r)."""
        slopes = ACTIVATIONS[self.activation].slope(eta / self.scales @ self.weights + self.biases)
        weights = self.weights / self.scales[:, None]
        found: Array = np.einsum("kn,...n,nm->...mk", weights, slopes, self.readout, optimize=True)
        return found

    @property
    def form(self) -> str:
        """Its neurons and their activation."""
        return f"{self.biases.size} {self.activation}"

    @property
    def parameter_count(self) -> int:
        """Weights and biases of both layers."""
        return self.weights.size + self.biases.size + self.readout.size + self.constant.size

    def kernel(self) -> tuple[NamedTuple, int]:
        """A single loop over neurons for each coordinate and each output."""
        layer = np.concatenate([(self.weights / self.scales[:, None]).ravel(), self.biases])
        kernel = NetworkMapKernel(
            ACTIVATIONS[self.activation].tag,
            layer,
            np.ascontiguousarray(self.readout.T).ravel(),
            np.array(self.constant),
        )
        return kernel, self.scales.size + self.biases.size

    def arrays(self) -> dict[str, np.ndarray]:
        """What makes this map."""
        names = ("scales", "weights", "biases", "readout", "constant")
        return {name: getattr(self, name) for name in names}


def save_map(learned: LearnedMap, path: str | Path) -> None:
    """Write `learned` to `path` whole: beside its place first, then moved there."""
    header = {"kind": learned.kind, "output_names": learned.output_names}
    if isinstance(learned, NetworkMap):
        header["activation"] = learned.activation
    write_archive(path, FORMAT, header, learned.arrays())


def load_map(path: str | Path) -> LearnedMap:
    """The map in `path`. Raises SurrogateFileError for a damaged or foreign file, OSError for none."""
    return read_archive(path, FORMAT, "a learned map", _map)


def _map(header: dict[str, Any], arrays: dict[str, Any]) -> LearnedMap:
    names = tuple(header["output_names"])
    if header["kind"] == PolynomialMap.kind:
        exponents = arrays.pop("exponents").astype(np.int64, casting="safe")
        return PolynomialMap(output_names=names, exponents=exponents, **arrays)
    return NetworkMap(output_names=names, activation=header["activation"], **arrays)
