"""Hyperparameter sweeps: spaces of values, searched as a grid or by random draws (config/sweeps/*.yaml)."""

from typing import Annotated, Any, Literal, Self

from pydantic import (
    Field,
    SerializerFunctionWrapHandler,
    field_validator,
    model_serializer,
    model_validator,
)

from flexsurr.config.activation import Activation
from flexsurr.config.schema import Record
from flexsurr.config.structure import Positive
from flexsurr.config.study import Count

Architecture = Literal["mlp", "hnn", "dissipative_hnn", "port_hamiltonian", "polynomial"]
ScalingKind = Literal["canonical", "per_feature"]
Optimiser = Literal["adam", "adam_cosine", "lbfgs", "levenberg_marquardt", "least_squares"]


class Trial(Record):
    """The resolved parameters of one training run, apart from its data. Hashed into the run_id."""

    architecture: Architecture
    hidden: tuple[Count, ...] = ()
    activation: Activation | None = None
    degree: Count | None = None
    optimiser: Optimiser = "levenberg_marquardt"
    epochs: Count = 1000
    batch_size: Count | None = None
    learning_rate: Positive | None = None
    precision: Literal["single", "double"] = "double"
    patience: Count | None = None
    time_limit_s: Positive | None = None
    seed: Annotated[int, Field(ge=0)] = 0
    scaling: ScalingKind = "canonical"

    @model_validator(mode="after")
    def _fits_the_architecture(self) -> Self:
        if self.architecture == "polynomial" or (
            self.architecture == "port_hamiltonian" and not self.hidden and self.activation is None
        ):
            self._check_polynomial()
        else:
            self._check_network()
        if self.scaling == "per_feature" and self.architecture in ("polynomial", "port_hamiltonian"):
            raise ValueError(f"{self.architecture} takes no scaling but canonical")
        if self.optimiser in ("adam", "adam_cosine") and (
            self.learning_rate is None or self.batch_size is None
        ):
            raise ValueError(f"{self.optimiser} takes learning_rate and batch_size")
        return self

    def _check_polynomial(self) -> None:
        if self.degree is None or self.hidden or self.activation is not None:
            if self.architecture == "port_hamiltonian":
                raise ValueError("port_hamiltonian takes degree, or hidden and activation")
            raise ValueError("polynomial takes degree, and neither hidden nor activation")
        if self.optimiser != "least_squares":
            raise ValueError(f"{self.architecture} with a degree takes the optimiser least_squares")

    def _check_network(self) -> None:
        if not self.hidden or self.activation is None or self.degree is not None:
            raise ValueError(f"{self.architecture} takes hidden and activation, and no degree")
        if self.optimiser == "least_squares":
            raise ValueError(f"{self.architecture} is not linear in its weights: least_squares cannot fit it")
        if self.architecture == "port_hamiltonian":
            if len(self.hidden) != 1:
                raise ValueError(f"port_hamiltonian takes one hidden layer, not {len(self.hidden)}")
            if self.optimiser != "levenberg_marquardt":
                raise ValueError("port_hamiltonian with hidden takes the optimiser levenberg_marquardt")

    @model_serializer(mode="wrap")
    def _without_the_usual_scaling(self, handler: SerializerFunctionWrapHandler) -> dict[str, Any]:
        """Leave `scaling` out where it is canonical: trials of before it existed keep their run_id."""
        values: dict[str, Any] = handler(self)
        if self.scaling == "canonical":
            values.pop("scaling", None)
        return values


class Space(Record):
    """Values to combine; a key with several values is a dimension of the search."""

    architecture: Architecture
    hidden: Annotated[tuple[tuple[Count, ...], ...], Field(min_length=1)] | None = None
    activation: Annotated[tuple[Activation, ...], Field(min_length=1)] | None = None
    degree: Annotated[tuple[Count, ...], Field(min_length=1)] | None = None
    optimiser: Annotated[tuple[Optimiser, ...], Field(min_length=1)] | None = None
    epochs: Annotated[tuple[Count, ...], Field(min_length=1)] | None = None
    batch_size: Annotated[tuple[Count, ...], Field(min_length=1)] | None = None
    learning_rate: Annotated[tuple[Positive, ...], Field(min_length=1)] | None = None
    precision: Annotated[tuple[Literal["single", "double"], ...], Field(min_length=1)] | None = None
    patience: Annotated[tuple[Count, ...], Field(min_length=1)] | None = None
    time_limit_s: Annotated[tuple[Positive, ...], Field(min_length=1)] | None = None
    seed: Annotated[tuple[Annotated[int, Field(ge=0)], ...], Field(min_length=1)] | None = None
    scaling: Annotated[tuple[ScalingKind, ...], Field(min_length=1)] | None = None

    @field_validator("*", mode="before")
    @classmethod
    def _has_values(cls, value: Any) -> Any:
        if value is None:
            raise ValueError("a key without values; give a list of values, or leave the key out")
        return value


class Sweep(Record):
    """A search over one or more spaces: every combination, or `draws` random ones of each space."""

    search: Literal["grid", "random"] = "grid"
    draws: Count | None = None
    seed: int = 0
    spaces: Annotated[tuple[Space, ...], Field(min_length=1)]

    @model_validator(mode="after")
    def _draws_belong_to_random(self) -> Self:
        if (self.search == "random") != (self.draws is not None):
            raise ValueError("draws is given exactly when search is random")
        return self
