"""A study: one structure, its reduced model, dataset, sweeps and evaluation (config/studies/*.yaml)."""

from collections.abc import Iterable, Mapping
from typing import Annotated, Any, Literal, Self

from pydantic import Field, field_validator, model_validator

from flexsurr.config.history import Sine
from flexsurr.config.load import Load, TipForce
from flexsurr.config.schema import Record, check_once
from flexsurr.config.structure import Positive

Variant = Literal["hamiltonian", "as_printed"]
Count = Annotated[int, Field(ge=1)]
Share = Annotated[float, Field(gt=0.0, lt=1.0)]
SplitBy = Literal["trajectory", "sample"]
Activation = Literal["elu", "tanh", "softplus", "silu", "squareplus", "half_log", "atan", "cube"]
"""Activation functions; flexsurr.surrogates.activations has them."""
HigherModes = Literal["alike", "as_energetic", "as_forced"]

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
    """scipy_… are SciPy's, whose steps are Python: slow, and nothing has to be compiled. The others are
    compiled. Implicit, for stiff structures: scipy_radau, scipy_bdf, radau_iia_5; lsoda changes over by
    itself. gauss_legendre_… keep the energy.
    """
    step_s: Positive | None = None
    """The longest step [s], of which a whole number is made from one sample to the next; needed by rk4,
    dop853_fixed (order 8) and gauss_legendre_…, and refused by the others.
    """
    rtol: Positive | None = None
    """Relative tolerance of a step; for methods that choose their step. None: 1e-3."""
    atol: Positive | None = None
    """Absolute tolerance of a step, in the units of the states; likewise. None: 1e-6."""

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
    """r, the modes that are kept: at most the coordinates (joints times elements)."""
    normalisation: Literal["unit", "mass"] = "unit"
    """What each mode is scaled to: Euclidean norm 1, or modal mass 1. Prefer mass for more than one: a
    dissipative_hnn needs it.
    """
    about: Literal["undeformed", "equilibrium"] = "undeformed"
    """Where the modes are taken: undeformed, or in equilibrium under gravity."""


class InitialConditions(Record):
    """Ranges of the random initial states, in amplitudes that do not depend on how modes are normalised."""

    kind: Literal["modal", "joint"] = "modal"
    """modal: drawn for the coordinates of modes of unit norm, whatever `normalisation` is; joint: drawn for
    every joint and projected.
    """
    q_min_deg: float = -20.0
    """Least coordinate [°]. Of a unit-norm mode it is the root of the sum of squares of the joints' angles.
    """
    q_max_deg: float = 20.0
    """Largest coordinate [°]."""
    p_min_kg_m2_s: float = 0.0
    """Least momentum [kg m²/s]."""
    p_max_kg_m2_s: float = 1.5
    """Largest momentum [kg m²/s]."""
    # left out where it is not given, so that datasets and runs keep the names they had before there was it
    higher_modes: HigherModes = Field(default="alike", exclude_if=lambda value: value == "alike")
    """What the ranges, of a modal kind, are to the modes above the first. alike: the same. as_energetic: they
    shrink or grow, so that each mode has the energy of the first. as_forced: they shrink, as if a load of the
    same size on every mass-normalised mode had been let go. The energy of many modes makes violent motion,
    which soon is chaotic: nothing can follow it for long.
    """

    @model_validator(mode="after")
    def _modes_are_drawn(self) -> Self:
        if self.kind == "joint" and self.higher_modes != "alike":
            raise ValueError(
                f"higher_modes: {self.higher_modes!r} is not allowed with kind: joint; allowed: alike"
            )
        return self

    @model_validator(mode="after")
    def _ordered(self) -> Self:
        if self.q_min_deg >= self.q_max_deg:
            raise ValueError(
                f"q_min_deg: {self.q_min_deg:g} is not allowed; allowed: below q_max_deg: {self.q_max_deg:g}"
            )
        if self.p_min_kg_m2_s > self.p_max_kg_m2_s:
            raise ValueError(
                f"p_min_kg_m2_s: {self.p_min_kg_m2_s:g} is not allowed; allowed: at most p_max_kg_m2_s: "
                f"{self.p_max_kg_m2_s:g}"
            )
        return self


class DatasetSettings(Record):
    """Free responses from random initial states, in shards."""

    seed: Annotated[int, Field(ge=0)] | None = None
    """Seed of the initial states. None: the study's. Two datasets of a study need different ones."""
    trajectories: Annotated[int, Field(ge=2)] = 50
    """Trajectories in all."""
    trajectories_per_shard: Count = 10
    """Trajectories in a file; each file is a job."""
    duration_s: Positive = 0.2
    """Length of each trajectory, a whole number of steps [s]."""
    step_s: Positive = 0.001
    """Between samples [s]; the integrator's own steps do not depend on it."""
    split_by: SplitBy = "trajectory"
    """What is held out of training: whole trajectories, or single samples of every trajectory (as the paper
    did; neighbours of theirs train).
    """
    training_fraction: Share = 0.8
    """Share that trains; the rest validates."""
    initial_conditions: InitialConditions = InitialConditions()
    """Where trajectories start."""
    integrator: Integrator = Integrator(method="dop853", rtol=1e-10, atol=1e-12)
    """By which the trajectories are made."""

    @model_validator(mode="after")
    def _lasts_whole_steps(self) -> Self:
        check_steps(self.duration_s, self.step_s)
        return self

    @property
    def shards(self) -> int:
        """Number of shards; the last may hold fewer trajectories."""
        return -(-self.trajectories // self.trajectories_per_shard)


class LearnedLoadSettings(Record):
    """How the forced response's load is learned: its generalised forces, by polynomials and by a network."""

    dataset: str = DEFAULT
    """Whose configurations it is learned from: default, or one of further_datasets."""
    kinematics_degree: Count = 10
    """Degree of the polynomials that give positions and directions of the structure."""
    degree: Count = 6
    """Degree of the polynomials that give the generalised forces."""
    hidden: Count = 16
    """Neurons of the network that gives the generalised forces."""
    activation: Activation = "half_log"
    """Activation function of that network."""
    epochs: Count = 200
    """Epochs of its training, at most."""


class DescribedSimulations(Record):
    """How many simulations the described reduced model is timed on, at half a minute each."""

    as_printed: Count = 3
    """Simulations without the gyroscopic term."""
    hamiltonian: Count = 1
    """Simulations with it."""

    def of(self, variant: Variant) -> int:
        """The number for one variant."""
        number: int = getattr(self, variant)
        return number


class EvaluationSettings(Record):
    """Responses by which models are timed and measured, and by what each is stepped."""

    simulations: Count = 10
    """Free and forced responses by which every model is timed and measured."""
    described_simulations: DescribedSimulations = DescribedSimulations()
    """Of these, how many the described model is timed on."""
    scipy_simulations: Count = 3
    """Of these, how many are stepped by SciPy's Radau, at seconds each."""
    duration_s: Positive = 30.0
    """Length of each response, a whole number of output steps [s]."""
    output_step_s: Positive = 0.01
    """Between the samples at which errors are measured [s]."""
    repeats: Count = 5
    """How often each simulation of a compiled model is timed, until 20 ms are full; the median counts."""
    long_responses: Count = 5
    """Further free responses, by whose tip error runs are chosen."""
    validation_duration_s: Positive = 1.0
    """Length of the response of full and reduced order to the load held on, which shows what the reduction
    costs [s].
    """
    load: Load = TipForce(force_N=10.0, history=Sine(frequency_rad_s=50.0))
    """What acts in forced responses, from rest: one load, or several. By default 10 sin(50 t) N up at the
    tip.
    """
    longest_load_s: Positive = 5.0
    """The load ends at a random time up to this [s]."""
    learned_load: LearnedLoadSettings = LearnedLoadSettings()
    """How its generalised forces are learned."""
    reference_integrator: Integrator = Integrator(method="dop853", rtol=1e-12, atol=1e-14)
    """Gives the responses from which errors are measured: tight."""
    judging_integrator: Integrator = Integrator(method="dop853_fixed", step_s=0.01)
    """Gives the responses by which runs are chosen."""
    drawing_integrator: Integrator = Integrator(method="dop853", rtol=1e-10, atol=1e-12)
    """Gives the responses of the figures."""
    energy_integrator: Integrator = Integrator(method="gauss_legendre_6", step_s=0.002)
    """Gives the responses whose energy is drawn: one that does not drift by itself."""
    validation_integrator: Integrator = Integrator(method="radau_iia_5", rtol=1e-6, atol=1e-9)
    """Steps full and reduced order. Lumps at mid-element put frequencies into the full-order model far above
    anything seen in its response: an implicit method steps over them.
    """
    integrators: tuple[Integrator, ...] = (
        Integrator(method="dop853_fixed", step_s=0.01),
        Integrator(method="dop853", rtol=1e-7, atol=1e-9),
        Integrator(method="rk4", step_s=1e-3),
        Integrator(method="gauss_legendre_6", step_s=5e-3),
        Integrator(method="radau_iia_5", rtol=1e-6, atol=1e-9),
    )
    """Compiled ones that are timed beside SciPy's Radau."""

    @model_validator(mode="after")
    def _lasts_whole_steps(self) -> Self:
        check_steps(self.duration_s, self.output_step_s, "output_step_s")
        return self

    @model_validator(mode="after")
    def _the_load_begins_in_time(self) -> Self:
        start_s = self.load.start_s
        if not start_s < self.longest_load_s:
            raise ValueError(
                f"longest_load_s: {self.longest_load_s} is not allowed; allowed: more than {start_s}, where "
                "the load starts"
            )
        return self


class Statics(Record):
    """Static deflection under dead loads, held against the exact elastica."""

    tip_loads_N: Annotated[tuple[float, ...], Field(min_length=1)] = tuple(
        float(f) for f in range(0, 151, 10)
    )
    """Dead loads at the tip, positive upwards, whose deflection is held against the exact elastica [N]."""


class Selection(Record):
    """The rule by which a surrogate is chosen among the runs of an architecture, and among all."""

    error_at_most_percent: Positive | None = None
    """Of the runs whose worst error of long responses, or of rollouts, is at most so much, the one is chosen
    whose right-hand side takes the fewest operations. None, or where no run errs so little: the most
    accurate.
    """


class Learning(Record):
    """What every study that learns fields ẋ = f(x) has."""

    sweeps: Annotated[dict[str, str], Field(min_length=1)]
    """The files of its sweeps by names of yours. Figures show the one called default; the best surrogates of
    each stand side by side in the tables. One that the study this is `based_on` names is left out by null.
    """
    seed: Annotated[int, Field(ge=0)] = 2024
    """Seed of whatever is random, but for the trials' own."""
    selection: Selection = Selection()
    """Which surrogates are chosen."""

    @field_validator("sweeps", mode="before")
    @classmethod
    def _left_out_sweeps(cls, value: Any) -> Any:
        return left_out(value)

    @model_validator(mode="after")
    def _one_sweep_is_the_default(self) -> Self:
        if DEFAULT not in self.sweeps:
            raise ValueError(f"sweeps: {', '.join(self.sweeps)}; allowed: one of them is called {DEFAULT}")
        _check_names("sweeps", self.sweeps)
        return self


def left_out(value: Any) -> Any:
    """What another file names and this one sets to null is left out."""
    if not isinstance(value, Mapping):
        return value
    return {name: each for name, each in value.items() if each is not None}


def _check_names(key: str, names: Iterable[str]) -> None:
    for name in names:
        if not name.isidentifier():
            raise ValueError(f"{key}: {name!r} is no plain name; allowed: letters, digits and underscores")


class Study(Learning):
    """A study of one structure: trajectories of its reduced model train its surrogates."""

    source: Literal["trajectories"] = "trajectories"
    """Where its data come from: simulated trajectories."""
    structure: str
    """The file of its structure."""
    frequencies_also_of: tuple[str, ...] = ()
    """Files of structures whose natural frequencies are tabulated beside."""
    variants: Annotated[tuple[Variant, ...], Field(min_length=1)] = ("hamiltonian", "as_printed")
    """Which reference models there are: hamiltonian keeps the gyroscopic term; as_printed drops it, as the
    paper prints it. The first is shown where there is room for one.
    """
    reduction: Reduction
    """The modes that make the reduced model."""
    dataset: DatasetSettings = DatasetSettings()
    """What surrogates are trained on, and every surrogate is validated on."""
    further_datasets: dict[str, DatasetSettings] = Field(default_factory=dict)
    """More of them, by names of yours. One that the study this is `based_on` has is left out by null."""
    trains_on: dict[str, str] = Field(default_factory=dict)
    """For a sweep, the name of the further dataset that it trains on. Others train on `dataset`."""
    evaluation: EvaluationSettings = EvaluationSettings()
    """Responses by which models are timed and measured."""
    statics: Statics = Statics()
    """Static deflection, against the exact one."""

    @field_validator("further_datasets", "trains_on", mode="before")
    @classmethod
    def _left_out_datasets(cls, value: Any) -> Any:
        return left_out(value)

    @model_validator(mode="after")
    def _names_are_plain(self) -> Self:
        _check_names("further_datasets", self.further_datasets)
        check_once(self.variants, "variants: ")
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
