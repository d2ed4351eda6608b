"""A study: one structure, its reduced model, dataset, sweeps and evaluation (config/studies/*.yaml)."""

from collections.abc import Iterable, Mapping
from typing import Annotated, Any, Literal, Self

from pydantic import Field, field_validator, model_validator

from flexsurr.config.activation import Activation
from flexsurr.config.load import Load, Sine, TipForce
from flexsurr.config.schema import Record
from flexsurr.config.structure import Positive

Variant = Literal["hamiltonian", "as_printed"]
Count = Annotated[int, Field(ge=1)]
Share = Annotated[float, Field(gt=0.0, lt=1.0)]
SplitBy = Literal["trajectory", "sample"]

DEFAULT = "default"
"""What the sweep that figures show, and the dataset that surrogates are validated on, are called."""

CONFIGURATIONS = "configurations"
"""What stands for the dataset of runs that need none: they sample configurations, without a simulation."""

IntegratorMethod = Literal[
    "scipy_radau",
    "scipy_bdf",
    "scipy_lsoda",
    "scipy_rk45",
    "scipy_dop853",
    "rk4",
    "dop853_fixed",
    "dop853",
    "gauss_legendre_4",
    "gauss_legendre_6",
    "radau_iia_5",
]
WHOLE = 1e-6
"""Of the number of steps in a duration, what decimal fractions may err by."""

FIXED_STEP: tuple[IntegratorMethod, ...] = ("rk4", "dop853_fixed", "gauss_legendre_4", "gauss_legendre_6")


class Integrator(Record):
    """An integrator and its only settings: a step where the step is fixed, tolerances where it adapts."""

    method: IntegratorMethod
    step_s: Positive | None = None
    rtol: Positive | None = None
    atol: Positive | None = None

    @model_validator(mode="after")
    def _settings_fit_the_method(self) -> Self:
        if self.method in FIXED_STEP:
            if self.step_s is None or self.rtol is not None or self.atol is not None:
                raise ValueError(f"{self.method} takes step_s and no tolerances")
        elif self.step_s is not None:
            raise ValueError(f"{self.method} takes rtol and atol, no step_s")
        return self

    @property
    def label(self) -> str:
        """Method and settings in one word, as tables and legends show it."""
        settings = {"h": self.step_s, "rtol": self.rtol, "atol": self.atol}
        shown = ",".join(f"{name}={value:g}" for name, value in settings.items() if value is not None)
        return f"{self.method}({shown})" if shown else self.method


def check_steps(duration_s: float, step_s: float, step: str = "step_s") -> None:
    """ValueError unless a whole number of steps, one or more, makes `duration_s`; `step` is their key."""
    count = duration_s / step_s
    if round(count) < 1 or abs(count - round(count)) > WHOLE * count:
        raise ValueError(
            f"duration_s: {duration_s:g} is not allowed with {step}: {step_s:g}; allowed: a whole number of "
            f"steps, such as {max(round(count), 1) * step_s:g}"
        )


class Reduction(Record):
    """The reduced-order model, eq. 10: r modes about an equilibrium."""

    modes: Count
    normalisation: Literal["unit", "mass"] = "unit"
    about: Literal["undeformed", "equilibrium"] = "undeformed"


class InitialConditions(Record):
    """Ranges of the random initial states, in amplitudes of unit-norm modes (modal) or joints (joint)."""

    kind: Literal["modal", "joint"] = "modal"
    q_min_deg: float = -20.0
    q_max_deg: float = 20.0
    p_min_kg_m2_s: float = 0.0
    p_max_kg_m2_s: float = 1.5

    @model_validator(mode="after")
    def _ordered(self) -> Self:
        if self.q_min_deg >= self.q_max_deg:
            raise ValueError("q_min_deg must lie below q_max_deg")
        if self.p_min_kg_m2_s > self.p_max_kg_m2_s:
            raise ValueError("p_min_kg_m2_s must not lie above p_max_kg_m2_s")
        return self


class DatasetSettings(Record):
    """Free responses from random initial states, in shards; drawn by `seed`, or else by the study's.

    Whole trajectories are held out of training, or single samples of every trajectory (`split_by`).
    """

    seed: Annotated[int, Field(ge=0)] | None = None
    trajectories: Annotated[int, Field(ge=2)] = 50
    trajectories_per_shard: Count = 10
    duration_s: Positive = 0.2
    step_s: Positive = 0.001
    split_by: SplitBy = "trajectory"
    training_fraction: Share = 0.8
    initial_conditions: InitialConditions = InitialConditions()
    integrator: Integrator = Integrator(method="dop853", rtol=1e-10, atol=1e-12)

    @model_validator(mode="after")
    def _lasts_whole_steps(self) -> Self:
        check_steps(self.duration_s, self.step_s)
        return self

    @property
    def shards(self) -> int:
        """Number of shards; the last may hold fewer trajectories."""
        return -(-self.trajectories // self.trajectories_per_shard)


class LearnedLoadSettings(Record):
    """The forced response's load, learned from the configurations of one `dataset` of the study.

    Polynomials of `kinematics_degree` give positions and directions; the generalised forces that follow
    are fitted by a polynomial of `degree`, and by a network of `hidden` neurons in at most `epochs`.
    """

    dataset: str = DEFAULT
    kinematics_degree: Count = 10
    degree: Count = 6
    hidden: Count = 16
    activation: Activation = "half_log"
    epochs: Count = 200


class DescribedSimulations(Record):
    """How many simulations the described reduced model is timed on: it takes half a minute for each."""

    as_printed: Count = 3
    hamiltonian: Count = 1

    def of(self, variant: Variant) -> int:
        """The number for one variant."""
        number: int = getattr(self, variant)
        return number


class EvaluationSettings(Record):
    """Responses by which models are timed and judged.

    In forced responses `load` acts from rest until a random time within `longest_load_s`, or until the end of
    its own history; `learned_load` says how its generalised forces are learned. Integrators:
    `integrators` are timed, beside SciPy's Radau; `reference_integrator` gives what errors are measured from,
    `judging_integrator` the responses by which runs are chosen, `drawing_integrator` those of the figures,
    `energy_integrator` those whose energy is drawn, and `validation_integrator` full and reduced order.
    """

    simulations: Count = 10
    described_simulations: DescribedSimulations = DescribedSimulations()
    scipy_simulations: Count = 3
    duration_s: Positive = 30.0
    output_step_s: Positive = 0.01
    repeats: Count = 5
    long_responses: Count = 5
    validation_duration_s: Positive = 1.0
    load: Load = TipForce(force_N=10.0, history=Sine(frequency_rad_s=50.0))
    longest_load_s: Positive = 5.0
    learned_load: LearnedLoadSettings = LearnedLoadSettings()
    reference_integrator: Integrator = Integrator(method="dop853", rtol=1e-12, atol=1e-14)
    judging_integrator: Integrator = Integrator(method="dop853_fixed", step_s=0.01)
    drawing_integrator: Integrator = Integrator(method="dop853", rtol=1e-10, atol=1e-12)
    energy_integrator: Integrator = Integrator(method="gauss_legendre_6", step_s=0.002)
    # The lumps at mid-element put frequencies into the full-order model far above anything seen in its
    # response: an implicit method steps over them.
    validation_integrator: Integrator = Integrator(method="radau_iia_5", rtol=1e-6, atol=1e-9)
    integrators: tuple[Integrator, ...] = (
        Integrator(method="dop853_fixed", step_s=0.01),
        Integrator(method="dop853", rtol=1e-7, atol=1e-9),
        Integrator(method="rk4", step_s=1e-3),
        Integrator(method="gauss_legendre_6", step_s=5e-3),
        Integrator(method="radau_iia_5", rtol=1e-6, atol=1e-9),
    )

    @model_validator(mode="after")
    def _lasts_whole_steps(self) -> Self:
        check_steps(self.duration_s, self.output_step_s, "output_step_s")
        return self

    @model_validator(mode="after")
    def _the_load_begins_in_time(self) -> Self:
        start_s = self.load.history.start_s
        if not start_s < self.longest_load_s:
            raise ValueError(
                f"longest_load_s: {self.longest_load_s} is not allowed; allowed: more than {start_s}, where "
                "the load starts"
            )
        return self


class Statics(Record):
    """Dead tip loads for the comparison with the exact elastica."""

    tip_loads_N: Annotated[tuple[float, ...], Field(min_length=1)] = tuple(
        float(f) for f in range(0, 151, 10)
    )


class Learning(Record):
    """What every study has. Paths are relative to the folder that holds the Snakefile.

    `sweeps` names each sweep of the study; the best surrogates of each stand side by side in the tables.
    The one called `default` is the one the figures show. One of these that another file names is left out
    where its value is null. `seed` draws whatever is random, but for the trials' own.
    """

    sweeps: Annotated[dict[str, str], Field(min_length=1)]
    seed: Annotated[int, Field(ge=0)] = 2024

    @field_validator("sweeps", mode="before")
    @classmethod
    def _left_out_sweeps(cls, value: Any) -> Any:
        return _left_out(value)

    @model_validator(mode="after")
    def _one_sweep_is_the_default(self) -> Self:
        if DEFAULT not in self.sweeps:
            raise ValueError(f"sweeps: one of them is called {DEFAULT}")
        _check_names("sweeps", self.sweeps)
        return self


def _left_out(value: Any) -> Any:
    """What another file names and this one sets to null is left out."""
    if not isinstance(value, Mapping):
        return value
    return {name: each for name, each in value.items() if each is not None}


def _check_names(key: str, names: Iterable[str]) -> None:
    for name in names:
        if not name.isidentifier():
            raise ValueError(f"{key}: {name!r} is no plain name; allowed: letters, digits and underscores")


class Study(Learning):
    """A study of one structure: trajectories of its reduced model train its surrogates.

    Besides `dataset`, which every surrogate is validated on, there may be `further_datasets`, and `trains_on`
    says which of them a sweep trains on. One of these that another file names is left out where its value is
    null. `frequencies_also_of` names structures whose natural frequencies are tabulated beside those of the
    study's own.
    """

    source: Literal["trajectories"] = "trajectories"
    structure: str
    frequencies_also_of: tuple[str, ...] = ()
    variants: Annotated[tuple[Variant, ...], Field(min_length=1)] = ("hamiltonian", "as_printed")
    reduction: Reduction
    dataset: DatasetSettings = DatasetSettings()
    further_datasets: dict[str, DatasetSettings] = Field(default_factory=dict)
    trains_on: dict[str, str] = Field(default_factory=dict)
    evaluation: EvaluationSettings = EvaluationSettings()
    statics: Statics = Statics()

    @field_validator("further_datasets", "trains_on", mode="before")
    @classmethod
    def _left_out_datasets(cls, value: Any) -> Any:
        return _left_out(value)

    @model_validator(mode="after")
    def _names_are_plain(self) -> Self:
        _check_names("further_datasets", self.further_datasets)
        if len(set(self.variants)) != len(self.variants):
            raise ValueError("variants: each at most once")
        return self

    @model_validator(mode="after")
    def _datasets_are_apart(self) -> Self:
        for taken, what in ((DEFAULT, "`dataset`"), (CONFIGURATIONS, "a sample without a simulation")):
            if taken in self.further_datasets:
                raise ValueError(
                    f"further_datasets: {taken!r} is what {what} is called; another name is needed"
                )
        seeds = {"dataset": self.seed_of(self.dataset)}
        for name, dataset in self.further_datasets.items():
            seed = self.seed_of(dataset)
            twin = next((other for other, used in seeds.items() if used == seed), None)
            if twin is not None:
                raise ValueError(
                    f"further_datasets.{name}.seed: {seed} draws the same trajectories as {twin}; "
                    "another seed is needed"
                )
            seeds[f"further_datasets.{name}"] = seed
        for sweep, name in self.trains_on.items():
            if sweep not in self.sweeps:
                raise ValueError(f"trains_on: {sweep!r} is no sweep; allowed: {', '.join(self.sweeps)}")
            if name not in self.datasets:
                raise ValueError(
                    f"trains_on.{sweep}: {name!r} is not allowed; allowed: {', '.join(self.datasets)}"
                )
        name = self.evaluation.learned_load.dataset
        if name not in self.datasets:
            raise ValueError(
                f"evaluation.learned_load.dataset: {name!r} is not allowed; "
                f"allowed: {', '.join(self.datasets)}"
            )
        return self

    @property
    def datasets(self) -> dict[str, DatasetSettings]:
        """Every dataset by its name; `dataset` is called "default"."""
        return {DEFAULT: self.dataset, **self.further_datasets}

    def seed_of(self, dataset: DatasetSettings) -> int:
        """The seed by which the trajectories of a dataset are drawn."""
        return self.seed if dataset.seed is None else dataset.seed

    def dataset_of(self, sweep: str) -> str:
        """The name of the dataset that a sweep trains on."""
        return self.trains_on.get(sweep, DEFAULT)
