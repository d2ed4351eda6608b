"""The jobs of a study of several numbers of modes: for each those of a study of trajectories without data."""

from functools import cached_property

from flexsurr.config.sources import ResolvedModesStudy
from flexsurr.workflow.study_plan import Job, Run, StudyPlan, trials_of
from flexsurr.workflow.trajectory_plan import TrajectoryPlan

# What every model of one number of modes is timed and measured on.
RIVALS = (
    "seed",
    "reduction",
    "dataset.initial_conditions",
    "evaluation.simulations",
    "evaluation.duration_s",
    "evaluation.output_step_s",
    "evaluation.scipy_simulations",
    "evaluation.repeats",
    "evaluation.reference_integrator",
    "evaluation.integrators",
)


class ModesPlan(StudyPlan):
    """Every job of such a study. Raises ConfigurationError for a sweep whose combinations don't fit."""

    source = "modes"

    def __init__(self, resolved: ResolvedModesStudy) -> None:
        study = resolved.study
        trials = trials_of(resolved.sweeps, study.sweeps, resolved.own_networks)
        super().__init__(resolved.name, trials)
        self.structure = resolved.structure.name
        self.plans = {str(modes): TrajectoryPlan(resolved.of(modes)) for modes in study.modes}

    @cached_property
    def sweeps(self) -> dict[str, dict[str, Run]]:
        """The runs of each sweep by their run_id, for all numbers of modes that it is trained for."""
        return {
            sweep: {
                key: run for plan in self.plans.values() for key, run in plan.sweeps.get(sweep, {}).items()
            }
            for sweep in self.trials
        }

    def shards(self, data: str) -> int:
        """None: nothing is simulated."""
        return 0

    def train(self, key: str) -> Job:
        """One training run."""
        return self._plan_of(key).train(key)

    def trains_on(self, key: str) -> list[str]:
        """Nothing: configurations are sampled."""
        return []

    def score(self, key: str) -> Job:
        """Long responses of one run."""
        return self._plan_of(key).score(key)

    def scored_on(self, key: str) -> list[str]:
        """Nothing: there are no held-out trajectories."""
        return []

    def rivals(self, modes: str) -> Job:
        """Wall times and errors of all runs of one number of modes."""
        return self.plans[modes].part(RIVALS) | {"study": self.name, "runs": list(self.plans[modes].runs)}

    @property
    def evaluation(self) -> dict[str, list[str]]:
        """The names of the files that its evaluation makes, by the rule that makes them."""
        return {"rivals": [f"rivals-{modes}" for modes in self.plans]}

    def _plan_of(self, key: str) -> TrajectoryPlan:
        return next(plan for plan in self.plans.values() if key in plan.runs)
