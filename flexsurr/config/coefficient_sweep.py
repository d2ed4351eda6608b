"""What is learned of the airliner's aerodynamics (config/sweeps/airliner.yaml)."""

from typing import Annotated, Literal, Self

from pydantic import Field, field_validator, model_validator

from flexsurr.config.activation import Activation
from flexsurr.config.schema import Record
from flexsurr.config.structure import Positive
from flexsurr.config.study import Count

Sampling = Literal["pseudo_random", "sobol"]
CoefficientModel = Literal["network", "linear", "quadratic"]
Optimiser = Literal["levenberg_marquardt", "lbfgs"]
Networks = Literal["one", "four"]
Inputs = Literal["features", "second_order"]
LatticeForm = Literal["full", "linear_in_modes"]
Seed = Annotated[int, Field(ge=0)]


class CoefficientTrial(Record):
    """The resolved parameters of one fit, apart from its samples. Hashed into the run_id.

    linear and quadratic are the baselines, by linear least squares. `lattice` is what was sampled:
    linear_in_modes is to first order in the modal coordinates and velocities. `networks`: four is one for
    drag, one for the longitudinal, one for the lateral-directional outputs, one for the modal ones, each
    with `hidden` neurons. `inputs`: second_order adds products of features.
    """

    model: CoefficientModel = "network"
    sampling: Sampling = "pseudo_random"
    lattice: LatticeForm = "full"
    networks: Networks = "one"
    inputs: Inputs = "features"
    hidden: Count | None = None
    activation: Activation | None = None
    optimiser: Optimiser | None = None
    epochs: Count | None = None
    time_limit_s: Positive | None = None
    seed: Seed = 0

    @model_validator(mode="after")
    def _fits_the_model(self) -> Self:
        settings = (self.hidden, self.activation, self.optimiser, self.epochs)
        if self.model == "network":
            if None in settings:
                raise ValueError("a network takes hidden, activation, optimiser and epochs")
        elif settings != (None,) * 4 or self.time_limit_s is not None:
            raise ValueError(f"{self.model} is fitted by least squares; it takes sampling and lattice alone")
        elif (self.networks, self.inputs) != ("one", "features"):
            raise ValueError(f"{self.model} is no network; it takes neither networks nor inputs")
        return self

    @property
    def dataset(self) -> str:
        """The name of the samples it is fitted to."""
        return dataset_name(self.sampling, self.lattice)

    @property
    def label(self) -> str:
        """What it is called in tables: all trials with the same label are one kind of model."""
        kind = f"four_networks_of_{self.hidden}" if self.networks == "four" else self.model
        second = "_second_order" if self.inputs == "second_order" else ""
        return kind + second + ("_linear_modes" if self.lattice == "linear_in_modes" else "")


def dataset_name(sampling: str, lattice: str) -> str:
    """The name of the samples that are drawn like this from a form of the lattice."""
    return sampling if lattice == "full" else f"{sampling}-{lattice}"


class CoefficientSpace(Record):
    """Values to combine, all with all."""

    model: CoefficientModel = "network"
    sampling: Annotated[tuple[Sampling, ...], Field(min_length=1)] = ("pseudo_random",)
    lattice: Annotated[tuple[LatticeForm, ...], Field(min_length=1)] = ("full",)
    networks: Annotated[tuple[Networks, ...], Field(min_length=1)] = ("one",)
    inputs: Annotated[tuple[Inputs, ...], Field(min_length=1)] = ("features",)
    hidden: Annotated[tuple[Count, ...], Field(min_length=1)] | None = None
    activation: Annotated[tuple[Activation, ...], Field(min_length=1)] | None = None
    optimiser: Annotated[tuple[Optimiser, ...], Field(min_length=1)] | None = None
    epochs: Annotated[tuple[Count, ...], Field(min_length=1)] | None = None
    time_limit_s: Annotated[tuple[Positive, ...], Field(min_length=1)] | None = None
    seed: Annotated[tuple[Seed, ...], Field(min_length=1)] = (0,)


class CoefficientSweep(Record):
    """What is fitted to the samples."""

    spaces: Annotated[tuple[CoefficientSpace, ...], Field(min_length=1)]

    @field_validator("spaces")
    @classmethod
    def _has_a_network(cls, spaces: tuple[CoefficientSpace, ...]) -> tuple[CoefficientSpace, ...]:
        if all(space.model != "network" for space in spaces):
            raise ValueError("none of them is of a network; one is needed to fly with")
        return spaces
