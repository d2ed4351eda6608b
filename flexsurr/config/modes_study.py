"""A study of one structure with more and more modes: which surrogate stands for how many (source: modes)."""

from typing import Annotated, Any, Literal, Self

from pydantic import Field, field_validator, model_validator

from flexsurr.config.schema import Record, check_once
from flexsurr.config.structure import Positive
from flexsurr.config.study import (
    DEFAULT,
    Count,
    DatasetSettings,
    EvaluationSettings,
    InitialConditions,
    Integrator,
    Learning,
    Reduction,
    Study,
    check_steps,
    left_out,
)


class ModesEvaluation(Record):
    """Free responses by which every run is timed and measured, beside the compiled reduced model."""

    simulations: Count = 4
    """Free responses that every model is timed and measured on."""
    long_responses: Count = 2
    """Further ones, which score a run after training."""
    duration_s: Positive = 30.0
    """Length of each, a whole number of output steps [s]."""
    output_step_s: Positive = 0.01
    """Between the samples at which errors are measured [s]."""
    repeats: Count = 5
    """How often each is timed; the median counts."""
    reference_integrator: Integrator = Integrator(method="dop853", rtol=1e-10, atol=1e-12)
    """Gives the responses from which errors are measured: tight."""
    integrator: Integrator = Integrator(method="dop853_fixed", step_s=0.005)
    """Steps all models alike."""

    @model_validator(mode="after")
    def _lasts_whole_steps(self) -> Self:
        check_steps(self.duration_s, self.output_step_s, "output_step_s")
        return self


class ModesStudy(Learning):
    """Reduced models of one structure, of few modes and of many, and what stands for each."""

    source: Literal["modes"]
    """Where its data come from: mass matrices of sampled configurations. Nothing is simulated to train on."""
    structure: str
    """The file of its structure."""
    modes: Annotated[tuple[Count, ...], Field(min_length=1)]
    """Numbers of modes r: every run is trained for each of them."""
    trained_for: dict[str, tuple[Count, ...]] = Field(default_factory=dict)
    """For a sweep, but not for the one called default, those of `modes` that it is trained for. Others are
    trained for all, as is one that is set to null.
    """
    normalisation: Literal["unit", "mass"] = "mass"
    """What each mode is scaled to: Euclidean norm 1, or modal mass 1."""
    initial_conditions: InitialConditions = InitialConditions()
    """Where responses start."""
    evaluation: ModesEvaluation = ModesEvaluation()
    """Responses by which models are timed and measured."""

    @field_validator("trained_for", mode="before")
    @classmethod
    def _left_out_sweeps_too(cls, value: Any) -> Any:
        return left_out(value)

    @field_validator("modes")
    @classmethod
    def _are_different(cls, modes: tuple[int, ...]) -> tuple[int, ...]:
        check_once(modes)
        return modes

    @model_validator(mode="after")
    def _sweeps_are_trained_for_what_there_is(self) -> Self:
        for sweep, some in self.trained_for.items():
            allowed = [name for name in self.sweeps if name != DEFAULT]
            if sweep not in allowed:
                raise ValueError(
                    f"trained_for: {sweep!r} is not allowed; allowed: {', '.join(allowed) or 'no sweep'}"
                )
            if others := sorted({*some} - {*self.modes}):
                raise ValueError(
                    f"trained_for.{sweep}: {others[0]} is not allowed; "
                    f"allowed: {', '.join(map(str, self.modes))}"
                )
        return self

    def of(self, modes: int) -> Study:
        """The study of trajectories that one number of modes makes."""
        evaluation = self.evaluation
        return Study(
            sweeps={
                name: file
                for name, file in self.sweeps.items()
                if modes in self.trained_for.get(name, self.modes)
            },
            seed=self.seed,
            structure=self.structure,
            variants=("hamiltonian",),
            reduction=Reduction(modes=modes, normalisation=self.normalisation),
            dataset=DatasetSettings(initial_conditions=self.initial_conditions),
            evaluation=EvaluationSettings(
                simulations=evaluation.simulations,
                long_responses=evaluation.long_responses,
                duration_s=evaluation.duration_s,
                output_step_s=evaluation.output_step_s,
                repeats=evaluation.repeats,
                reference_integrator=evaluation.reference_integrator,
                judging_integrator=evaluation.integrator,
                integrators=(evaluation.integrator,),
            ),
        )
