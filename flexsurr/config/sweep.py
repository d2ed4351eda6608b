"""Hyperparameter sweeps: spaces of values, searched as a grid or by random draws (config/sweeps/*.yaml)."""

from collections.abc import Mapping
from typing import Annotated, Any, Literal, Self

from pydantic import Field, field_validator, model_validator

from flexsurr.config.activation import Activation
from flexsurr.config.schema import Record
from flexsurr.config.structure import Positive
from flexsurr.config.study import Count

Architecture = Literal["mlp", "hnn", "dissipative_hnn", "port_hamiltonian", "polynomial"]
ScalingKind = Literal["canonical", "per_feature", "min_max"]
Optimiser = Literal["adam", "adam_cosine", "lbfgs", "levenberg_marquardt", "least_squares"]
Precision = Literal["single", "double"]
Loss = Literal["nmse", "mean_square", "norms"]
Keep = Literal["best", "last"]

NETWORK = {"hidden": ..., "activation": ...}
POLYNOMIAL = {"degree": ...}
LIMITS = {"epochs": 1000, "patience": None, "time_limit_s": None, "keep": "best", "seed": 0}
STOCHASTIC = {
    "learning_rate": ...,
    "batch_size": ...,
    "precision": "double",
    "loss": "nmse",
}

ARCHITECTURE_SETTINGS: dict[Architecture, dict[str, Any]] = {
    "mlp": {**NETWORK, "scaling": "canonical"},
    "hnn": {**NETWORK, "scaling": "canonical"},
    "dissipative_hnn": {**NETWORK, "scaling": "canonical"},
    "polynomial": POLYNOMIAL,
    "port_hamiltonian": POLYNOMIAL,  # a network where `hidden` or `activation` is given
}
"""What each architecture takes, with its default; an ellipsis stands for none: it must be given."""

OPTIMISER_SETTINGS: dict[Optimiser, dict[str, Any]] = {
    "least_squares": {},
    "levenberg_marquardt": LIMITS,
    "lbfgs": LIMITS,
    "adam": {**LIMITS, **STOCHASTIC},
    "adam_cosine": {**LIMITS, **STOCHASTIC},
}
"""The same of each optimiser."""


class Trial(Record):
    """The resolved parameters of one training run, apart from its data. Hashed into the run_id.

    What its architecture and its optimiser do not take is None; giving it is an error. `loss` is what first-
    order optimisers minimise: the nmse, the mean of squares of the scaled rates' errors, or eqs. 11 and 12
    as printed (`norms`: a sample's ‖error of q̇‖ + ‖error of ṗ‖, and their mean over a batch). `keep` says
    whether the weights are those that validated best or those of the last epoch. With a number of
    `configurations` the trial trains on those, sampled without a simulation, instead of a dataset.
    """

    architecture: Architecture
    configurations: Count | None = None
    hidden: tuple[Count, ...] | None = None
    activation: Activation | None = None
    degree: Count | None = None
    scaling: ScalingKind | None = None
    optimiser: Optimiser = "levenberg_marquardt"
    epochs: Count | None = None
    batch_size: Count | None = None
    learning_rate: Positive | None = None
    precision: Precision | None = None
    loss: Loss | None = None
    keep: Keep | None = None
    patience: Count | None = None
    time_limit_s: Positive | None = None
    seed: Annotated[int, Field(ge=0)] | None = None

    @model_validator(mode="before")
    @classmethod
    def _takes_what_is_given(cls, values: Any) -> Any:
        """Fill in defaults; refuse what would do nothing."""
        if not isinstance(values, Mapping):
            return values
        architecture = values.get("architecture")
        optimiser = values.get("optimiser", "levenberg_marquardt")
        if architecture not in ARCHITECTURE_SETTINGS or optimiser not in OPTIMISER_SETTINGS:
            return values  # the fields' own types say what is allowed
        given = {key: value for key, value in values.items() if value is not None}
        takes = ARCHITECTURE_SETTINGS[architecture]
        if architecture == "port_hamiltonian" and not {"hidden", "activation"}.isdisjoint(given):
            takes = NETWORK
        is_polynomial = takes is POLYNOMIAL
        of_both = {**takes, **OPTIMISER_SETTINGS[optimiser], "configurations": None}
        known = given.keys() & cls.model_fields.keys()
        for key in sorted(known - of_both.keys() - {"architecture", "optimiser"}):
            owner = architecture if key in (*NETWORK, *POLYNOMIAL, "scaling") else optimiser
            raise ValueError(
                f"{key} does nothing with {owner}; allowed: {', '.join(sorted(of_both)) or 'nothing more'}"
            )
        missing = [key for key, default in of_both.items() if default is ... and key not in given]
        if missing:
            raise ValueError(f"{architecture} with {optimiser} takes {' and '.join(missing)}")
        if is_polynomial != (optimiser == "least_squares"):
            allowed = "least_squares" if is_polynomial else "any but least_squares"
            raise ValueError(f"optimiser: {optimiser!r} does not fit this {architecture}; allowed: {allowed}")
        return {key: default for key, default in of_both.items() if default is not ...} | given

    @model_validator(mode="after")
    def _fits_the_architecture(self) -> Self:
        if self.hidden is not None and not self.hidden:
            raise ValueError("hidden: one or more layers")
        if self.architecture == "port_hamiltonian" and self.hidden is not None:
            if len(self.hidden) != 1:
                raise ValueError(f"port_hamiltonian takes one hidden layer, not {len(self.hidden)}")
            if self.optimiser != "levenberg_marquardt":
                raise ValueError("port_hamiltonian with hidden takes the optimiser levenberg_marquardt")
        return self


class Space(Record):
    """Values to combine; a key with several values is a dimension of the search."""

    architecture: Architecture
    configurations: Annotated[tuple[Count, ...], Field(min_length=1)] | None = None
    hidden: Annotated[tuple[tuple[Count, ...], ...], Field(min_length=1)] | None = None
    activation: Annotated[tuple[Activation, ...], Field(min_length=1)] | None = None
    degree: Annotated[tuple[Count, ...], Field(min_length=1)] | None = None
    optimiser: Annotated[tuple[Optimiser, ...], Field(min_length=1)] | None = None
    epochs: Annotated[tuple[Count, ...], Field(min_length=1)] | None = None
    batch_size: Annotated[tuple[Count, ...], Field(min_length=1)] | None = None
    learning_rate: Annotated[tuple[Positive, ...], Field(min_length=1)] | None = None
    precision: Annotated[tuple[Precision, ...], Field(min_length=1)] | None = None
    loss: Annotated[tuple[Loss, ...], Field(min_length=1)] | None = None
    keep: Annotated[tuple[Keep, ...], Field(min_length=1)] | None = None
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
