"""A study: one structure, its reduced model, dataset, sweeps and evaluation (config/studies/*.yaml)."""

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from flexsurr.config.schema import Record
from flexsurr.config.structure import NotNegative, Positive

Variant = Literal["hamiltonian", "as_printed"]
Count = Annotated[int, Field(ge=1)]

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
    """Free responses from random initial states, in shards."""

    trajectories: Annotated[int, Field(ge=2)] = 50
    trajectories_per_shard: Count = 10
    duration_s: Positive = 0.2
    step_s: Positive = 0.001
    training_fraction: Annotated[float, Field(gt=0.0, lt=1.0)] = 0.8
    initial_conditions: InitialConditions = InitialConditions()
    integrator: Integrator = Integrator(method="dop853", rtol=1e-10, atol=1e-12)

    @property
    def shards(self) -> int:
        """Number of shards; the last may hold fewer trajectories."""
        return -(-self.trajectories // self.trajectories_per_shard)


class TipForce(Record):
    """F(t) = amplitude sin(frequency t) along `direction` (clamp's frame), from 0 to a random end."""

    amplitude_N: float = 10.0
    frequency_rad_s: NotNegative = 50.0
    direction: tuple[float, float, float] = (0.0, 0.0, 1.0)
    longest_s: Positive = 5.0


class DescribedSimulations(Record):
    """How many simulations the described reduced model is timed on: it takes half a minute for each."""

    as_printed: Count = 3
    hamiltonian: Count = 1

    def of(self, variant: Variant) -> int:
        """The number for one variant."""
        number: int = getattr(self, variant)
        return number


class EvaluationSettings(Record):
    """Responses by which models are timed and judged."""

    simulations: Count = 10
    described_simulations: DescribedSimulations = DescribedSimulations()
    scipy_simulations: Count = 3
    duration_s: Positive = 30.0
    output_step_s: Positive = 0.01
    repeats: Count = 5
    long_responses: Count = 5
    validation_duration_s: Positive = 1.0
    force: TipForce = TipForce()
    integrators: tuple[Integrator, ...] = (
        Integrator(method="dop853_fixed", step_s=0.01),
        Integrator(method="dop853", rtol=1e-7, atol=1e-9),
        Integrator(method="rk4", step_s=1e-3),
        Integrator(method="gauss_legendre_6", step_s=5e-3),
        Integrator(method="radau_iia_5", rtol=1e-6, atol=1e-9),
    )


class Statics(Record):
    """Dead tip loads for the comparison with the exact elastica."""

    tip_loads_N: Annotated[tuple[float, ...], Field(min_length=1)] = tuple(
        float(f) for f in range(0, 151, 10)
    )


class Study(Record):
    """One study. Paths are relative to the folder that holds the Snakefile.

    `sweeps` names each sweep of the study; the best surrogates of each stand side by side in the tables.
    The one called `default` is the one the figures show. `frequencies_also_of` names structures whose
    natural frequencies are tabulated beside those of the study's own.
    """

    structure: str
    frequencies_also_of: tuple[str, ...] = ()
    sweeps: Annotated[dict[str, str], Field(min_length=1)]
    seed: Annotated[int, Field(ge=0)] = 2024
    variants: Annotated[tuple[Variant, ...], Field(min_length=1)] = ("hamiltonian", "as_printed")
    reduction: Reduction
    dataset: DatasetSettings = DatasetSettings()
    evaluation: EvaluationSettings = EvaluationSettings()
    statics: Statics = Statics()

    @model_validator(mode="after")
    def _names_are_plain(self) -> Self:
        if "default" not in self.sweeps:
            raise ValueError("sweeps: one of them is called default")
        for name in self.sweeps:
            if not name.isidentifier():
                raise ValueError(
                    f"sweeps: {name!r} is no plain name; allowed: letters, digits and underscores"
                )
        if len(set(self.variants)) != len(self.variants):
            raise ValueError("variants: each at most once")
        return self
