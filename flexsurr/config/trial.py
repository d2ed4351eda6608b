"""Trials: what is trained and by which optimiser, each with settings of its own.

A trial joins the record of an architecture with that of an optimiser. `isinstance` tells which, and so what
settings there are; whatever neither record takes is refused. A new architecture or optimiser is a record,
listed in FIELDS, MAPS or OPTIMISERS: sweeps and tables follow.
"""

from collections.abc import Iterable
from functools import cache
from types import NoneType
from typing import Annotated, Any, ClassVar, Literal, Self, cast, get_args

from pydantic import AfterValidator, Field, ValidationError, create_model, model_validator

from flexsurr.config.errors import nearest
from flexsurr.config.own_network import own_network
from flexsurr.config.schema import Record
from flexsurr.config.structure import Positive
from flexsurr.config.study import Activation, Count

ScalingKind = Literal["canonical", "per_feature", "min_max"]
Sampling = Literal["pseudo_random", "sobol"]
PotentialKind = Literal["polynomial"]
Device = Literal["cpu", "cuda", "auto"]
LatticeForm = Literal["full", "linear_in_modes"]
Layers = Annotated[tuple[Count, ...], Field(min_length=1)]


def _one(layers: tuple[int, ...]) -> tuple[int, ...]:
    if len(layers) != 1:
        raise ValueError(f"one hidden layer, not {len(layers)}")
    return layers


OneLayer = Annotated[Layers, AfterValidator(_one)]


class Architecture(Record):
    """What is trained. `optimisers` are those that can."""

    architecture: str
    """What is trained."""

    optimisers: ClassVar[tuple[str, ...]] = ("least_squares",)


class StateField(Architecture):
    """What gives the rates of the states."""

    configurations: Count | None = None
    """Configurations of the reduced model that it is trained on, sampled without a simulation. None: it is
    trained on a dataset.
    """


class TrainedField(StateField):
    """What is trained epoch by epoch."""

    # left out where it is not given, as give_up below
    samples_per_trajectory: Count | None = Field(default=None, exclude_if=lambda value: value is None)
    """Trains on at most so many samples of each trajectory, evenly spread; validation sees all of its own.
    Samples that lie close in time say almost the same, and each costs as much as any other.
    """


class FieldNetwork(TrainedField):
    """A network of the states' rates."""

    architecture: Literal["mlp", "hnn", "dissipative_hnn"]
    """mlp gives the rates themselves, hnn an energy, dissipative_hnn an energy and a dissipation."""
    hidden: Layers
    """Neurons of each hidden layer; dissipative_hnn has two networks of these."""
    activation: Activation
    """Activation function of its neurons. half_log (½ log(1 + z²)) and atan are the fastest to step of those
    with bounded slopes; elu's slope has a kink. cube (z³ / 3) makes a polynomial of the third degree.
    """
    scaling: ScalingKind = "canonical"
    """Of states and rates. canonical: one factor for all q, one for all p, which keeps Hamilton's equations;
    per_feature: each by its own spread; min_max: each from 0 to 1.
    """
    device: Device = Field(default="cpu", exclude_if=lambda value: value == "cpu")
    """Where it is trained; auto: on a GPU if there is one, by torch. Not for levenberg_marquardt."""

    optimisers = ("levenberg_marquardt", "lbfgs", "adam", "adam_cosine", "adamw", "adamw_cosine")


class EvenNetwork(TrainedField):
    """A network of an energy that is even in q and in p."""

    architecture: Literal["even_hnn"]
    """An energy that depends on products of coordinates and on products of momenta alone: for structures that
    are their own mirror image, without gravity across it, and not damped.
    """
    hidden: OneLayer
    """Neurons of its one hidden layer, in brackets all the same: [8]."""
    activation: Activation
    """Activation function of its neurons. Four of cube (z³ / 3) make nearly any polynomial of degree 6 in q
    and p, and are the fastest to step.
    """

    optimisers = ("levenberg_marquardt",)


class FieldPolynomial(StateField):
    """A polynomial Hamiltonian, or polynomials of mass matrix, stiffness and damping."""

    architecture: Literal["polynomial", "port_hamiltonian"]
    """polynomial gives an energy; port_hamiltonian mass matrix, stiffness and damping."""
    degree: Count
    """Degree of the polynomials."""
    # left out where it is not given, as give_up below
    terms: Literal["all", "sparse"] = Field(default="all", exclude_if=lambda value: value == "all")
    """Which monomials of the mass matrix there are. all: every one up to the degree. sparse, of
    port_hamiltonian with configurations alone: of each entry those that mirror symmetry leaves, and of these
    the fewest that are about as accurate.
    """
    potential: PotentialKind | None = Field(default=None, exclude_if=lambda value: value is None)
    """Of port_hamiltonian alone. polynomial: its potential is one, which knows weight and any equilibrium, as
    a structure under gravity needs. None: ½ qᵀKq.
    """

    @model_validator(mode="after")
    def _a_known_matrix_is_sparse(self) -> Self:
        if self.terms == "sparse" and (
            self.architecture != "port_hamiltonian" or self.configurations is None
        ):
            raise ValueError("terms: 'sparse' takes port_hamiltonian and configurations; allowed: all")
        return self

    @model_validator(mode="after")
    def _an_energy_holds_its_potential(self) -> Self:
        if self.potential is not None and self.architecture != "port_hamiltonian":
            raise ValueError(
                f"potential: {self.potential!r} is not allowed with polynomial, whose energy has any"
            )
        return self


class PortHamiltonianNetwork(TrainedField):
    """A network of the mass matrix."""

    architecture: Literal["port_hamiltonian"]
    """A mass matrix that depends on q, with a constant stiffness and damping."""
    hidden: OneLayer
    """Neurons of its one hidden layer, in brackets all the same: [32]."""
    activation: Activation
    """Activation function of its neurons."""
    potential: PotentialKind | None = Field(default=None, exclude_if=lambda value: value is None)
    """polynomial: the potential is one, found by least squares, which knows weight and any equilibrium, as a
    structure under gravity needs. None: ½ qᵀKq.
    """
    mass_matrix: Literal["factored", "entries", "mirrored"] = Field(
        default="factored", exclude_if=lambda value: value == "factored"
    )
    """What the network gives. factored: the factor of a mass matrix that is positive definite everywhere.
    entries: the matrix itself, which it learns in less time and far more accurately. mirrored, with
    configurations alone: the matrix, by neurons that come with their mirror images in the structure's planes
    of symmetry, which it then has exactly; `hidden` counts them without their images.
    """

    @model_validator(mode="after")
    def _mirrors_are_those_of_a_structure(self) -> Self:
        if self.mass_matrix == "mirrored" and self.configurations is None:
            raise ValueError(
                "mass_matrix: 'mirrored' is not allowed without configurations; allowed: factored, entries"
            )
        return self

    optimisers = ("levenberg_marquardt",)


def _of_users(architecture: str) -> str:
    if own_network(architecture) is None:
        raise ValueError("a file and a class in it, as in my_models.py:MyField")
    return architecture


class TorchModule(TrainedField):
    """A network of the user's own, by its file and class."""

    architecture: Annotated[str, AfterValidator(_of_users)]
    """A file below the project and a class in it, as in my_models.py:MyField. The file is executed."""
    options: dict[str, Any] = Field(default_factory=dict)
    """Keywords of the class. In a sweep each has a list of values."""
    scaling: ScalingKind = "canonical"
    """Of states and rates, as above."""
    device: Device = "cpu"
    """Where torch trains; auto: on a GPU if there is one."""
    sha256: str = ""
    """The hash of its file. It is found, not given: leave it out."""

    optimisers = ("lbfgs", "adam", "adam_cosine", "adamw", "adamw_cosine")


class Map(Architecture):
    """What gives coefficients of features, and how the samples that it is fitted to are drawn."""

    sampling: Sampling = "pseudo_random"
    """How samples fill their intervals: at random, or evenly by a Sobol sequence."""
    lattice: LatticeForm = "full"
    """What is sampled: the lattice, or to first order in the modal coordinates and velocities."""

    @property
    def dataset(self) -> str:
        """The name of the samples that it is fitted to."""
        return sample_name(self.sampling, self.lattice)

    @property
    def label(self) -> str:
        """What tables call it: all trials with the same label are one kind of model."""
        return self.architecture + ("_linear_modes" if self.lattice == "linear_in_modes" else "")


def sample_name(sampling: str, lattice: str) -> str:
    """The name of the samples that are drawn like this from a form of the lattice."""
    return sampling if lattice == "full" else f"{sampling}-{lattice}"


class MapPolynomial(Map):
    """A baseline: first or second order in the features."""

    architecture: Literal["linear", "quadratic"]
    """A polynomial of first or second order in the features."""


class MapNetwork(Map):
    """A network of one hidden layer, or four of them."""

    architecture: Literal["network"]
    """A network of one hidden layer."""
    networks: Literal["one", "four"] = "one"
    """one for all outputs, or four: for drag, the longitudinal, the lateral-directional and the modal ones,
    each with `hidden` neurons.
    """
    inputs: Literal["features", "second_order"] = "features"
    """The features, or products of them too."""
    hidden: OneLayer
    """Neurons of its one hidden layer, in brackets all the same: [75]."""
    activation: Activation
    """Activation function of its neurons."""

    optimisers = ("levenberg_marquardt", "lbfgs")

    @property
    def label(self) -> str:
        """That of its kind, the four networks with their number of neurons."""
        kind = f"four_networks_of_{self.hidden[0]}" if self.networks == "four" else "network"
        second = "_second_order" if self.inputs == "second_order" else ""
        return kind + second + super().label.removeprefix("network")


class Optimiser(Record):
    """By what it is trained."""

    optimiser: str
    """By what it is trained. None given in a space: levenberg_marquardt, or lbfgs for a class of yours."""


class LeastSquares(Optimiser):
    """Linear least squares, without iteration."""

    optimiser: Literal["least_squares"]
    """In one step; for polynomials."""


class GiveUp(Record):
    """When a trial is hopeless: in epochs, not in seconds, so that it does not depend on the machine."""

    after_epochs: Count
    """Epochs that it is given."""
    above_nmse: Positive
    """What the least nmse of validation must not be above by then."""

    def __str__(self) -> str:
        return f"after {self.after_epochs} epochs above {self.above_nmse:g}"


class Iterative(Optimiser):
    """Epoch after epoch."""

    epochs: Count = 1000
    """Epochs at most."""
    patience: Count | None = None
    """Ends after so many epochs without better validation (by 1 % or more). None: it does not end by this."""
    time_limit_s: Positive | None = None
    """Ends after this processor time [s]. It makes a result depend on the machine. None: no limit."""
    # left out where it is not given, so that runs keep the names they had before there was such a setting
    give_up: GiveUp | None = Field(default=None, exclude_if=lambda value: value is None)
    """When it ends as hopeless: stopped, neither scored nor chosen. None: never."""
    keep: Literal["best", "last"] = "best"
    """The weights that validated best, or those of the last epoch."""
    seed: Annotated[int, Field(ge=0)] = 0
    """Seed of the first weights and of the batches."""


class FullBatch(Iterative):
    """Every step sees all samples."""

    optimiser: Literal["levenberg_marquardt", "lbfgs"]
    """Every step sees all samples; levenberg_marquardt is for flexsurr's own networks."""


class FirstOrder(Iterative):
    """Steps along the gradient of a batch."""

    learning_rate: Positive
    """Length of a step over the gradient."""
    batch_size: Count
    """Samples of a step."""
    precision: Literal["single", "double"] = "double"
    """Precision of the arithmetic."""
    loss: Literal["nmse", "mean_square", "norms"] = "nmse"
    """What is minimised: the mean squared error over the variance; the mean of squares of the scaled rates'
    errors; or eqs. 11 and 12 as printed, a sample's ‖error of q̇‖ + ‖error of ṗ‖.
    """


class Adam(FirstOrder):
    """Adam, with or without the cosine."""

    optimiser: Literal["adam", "adam_cosine"]
    """At a constant rate, or one that falls to 0 as half a cosine."""


class AdamW(FirstOrder):
    """Adam where weights shrink at each step too."""

    optimiser: Literal["adamw", "adamw_cosine"]
    """The same."""
    weight_decay: Annotated[float, Field(ge=0)] = 0.01
    """At each step weights shrink by this times the rate."""


class Trial(Architecture, Optimiser):
    """The resolved parameters of one training run, apart from its data: `trial_of` makes one.

    Hashed into the run_id.
    """


FIELDS: tuple[type[Architecture], ...] = (
    FieldNetwork,
    EvenNetwork,
    FieldPolynomial,
    PortHamiltonianNetwork,
    TorchModule,
)
"""What a field may be learned by; of one name, the record fits that takes most of what is given."""

MAPS: tuple[type[Architecture], ...] = (MapPolynomial, MapNetwork)
"""What a map may be learned by."""

ON_DEVICE = {"lbfgs", "adam", "adam_cosine", "adamw", "adamw_cosine"}
"""What trains on a device too, where the architecture has a form in torch that autograd differentiates."""

OPTIMISERS: tuple[type[Optimiser], ...] = (FullBatch, Adam, AdamW, LeastSquares)
"""What trains; the first name is the one that holds where none is given, for torch modules their first."""


def named(records: Iterable[type[Record]], key: str) -> list[str]:
    """The names that the literals of `key` give the records, each once."""
    literals = [record.model_fields[key].annotation for record in records]
    return list(dict.fromkeys(name for literal in literals for name in get_args(literal)))


def trial_of(**settings: Any) -> Trial:
    """The trial with these settings; one that is None is as good as not given.

    Raises ValueError for what does nothing, what is missing, and what is not allowed.
    """
    given = {key: value for key, value in settings.items() if value is not None}
    (first, *_) = named(OPTIMISERS, "optimiser")
    is_users = own_network(str(given.get("architecture"))) is not None
    given.setdefault("optimiser", TorchModule.optimisers[0] if is_users else first)
    forms: list[Any] = [TorchModule]
    if not is_users:
        forms = _called("architecture", given.get("architecture"), (*FIELDS, *MAPS))
    form = max(forms, key=lambda form: len(form.model_fields.keys() & given.keys()))
    (optimiser,) = _called("optimiser", given["optimiser"], OPTIMISERS)
    takes = form.model_fields | optimiser.model_fields
    what, by = given["architecture"], given["optimiser"]
    on_cpu = form.optimisers if "device" not in takes else set(form.optimisers) - ON_DEVICE
    if given.get("device", "cpu") != "cpu" and by in on_cpu:
        others = [name for name in form.optimisers if name not in on_cpu]
        allowed = f"; on a device: {', '.join(others)}" if others else ""
        raise ValueError(f"device: {by} trains this {what} by compiled code, on the CPU{allowed}")
    if nothing := sorted(given.keys() - takes):
        known = any(nothing[0] in each.model_fields for each in OPTIMISERS)
        allowed = ", ".join(sorted(takes.keys() - {"architecture", "optimiser"})) or "nothing more"
        raise ValueError(f"{nothing[0]} does nothing with {by if known else what}; allowed: {allowed}")
    if missing := [key for key, field in takes.items() if field.is_required() and key not in given]:
        raise ValueError(f"{what} with {by} takes {' and '.join(missing)}")
    if by not in form.optimisers:
        allowed = ", ".join(form.optimisers)
        raise ValueError(f"optimiser: {by!r} does not fit this {what}; allowed: {allowed}")
    try:
        return _joined(form, optimiser)(**given)
    except ValidationError as error:
        problems = [
            f"{'.'.join(map(str, detail['loc']))}: {detail['msg'].removeprefix('Value error, ')}"
            for detail in error.errors()
        ]
        raise ValueError("; ".join(problems)) from None


def settings_of(trial: Trial) -> dict[str, Any]:
    """Every setting that a trial of its kind may have, as JSON has it: None where this one takes none."""
    values = trial.model_dump(mode="json")
    kind = MAPS if isinstance(trial, Map) else FIELDS
    # one that is left out of the names of runs has a value all the same
    return {key: values.get(key, getattr(trial, key, None)) for key in dimensions(kind)}


def configurations_of(trial: Architecture) -> int | None:
    """How many configurations a trial samples in place of a dataset; None where it trains on one."""
    return trial.configurations if isinstance(trial, StateField) else None


def dimensions(architectures: Iterable[type[Architecture]]) -> dict[str, Any]:
    """The types of everything that trials of `architectures` take, by name: what a sweep may vary."""
    forms = tuple(architectures)
    found: dict[str, Any] = {
        "architecture": _known(named(forms, "architecture"), TorchModule in forms),
        "optimiser": Literal[*named(OPTIMISERS, "optimiser")],
    }
    for record in (*forms, *OPTIMISERS):
        for key, field in record.model_fields.items():
            of_union = get_args(field.annotation)
            # `patience: Count | None` is varied among counts
            value = of_union[0] if NoneType in of_union else field.annotation
            found.setdefault(key, Annotated[value, *field.metadata] if field.metadata else value)
    return found


def _known(names: list[str], or_users: bool) -> Any:
    """One of the names or, where `or_users`, a network of the user's own."""
    if not or_users:
        return Literal[*names]

    def check(architecture: str) -> str:
        if architecture not in names and own_network(architecture) is None:
            raise ValueError(
                f"{architecture!r} is not allowed{nearest(architecture, names)}; "
                f"allowed: {', '.join(names)}, or a file and a class of yours, as in my_models.py:MyField"
            )
        return architecture

    return Annotated[str, AfterValidator(check)]


def _called(key: str, name: Any, records: Iterable[type[Record]]) -> list[Any]:
    found = [record for record in records if name in named([record], key)]
    if not found:
        raise ValueError(f"{key}: {name!r} is not allowed; allowed: {', '.join(named(records, key))}")
    return found


@cache
def _joined(form: type[Architecture], optimiser: type[Optimiser]) -> type[Trial]:
    bases: Any = (form, optimiser, Trial)
    return cast("type[Trial]", create_model(f"{form.__name__}By{optimiser.__name__}", __base__=bases))
