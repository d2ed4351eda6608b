"""The jobs of a study whose trajectories are simulated."""

from collections.abc import Mapping, Sequence

from flexsurr.config.errors import ConfigurationError
from flexsurr.config.load import turns_clamp
from flexsurr.config.schema import values_of
from flexsurr.config.sources import ResolvedStudy
from flexsurr.config.study import DEFAULT, Study
from flexsurr.config.trial import Trial
from flexsurr.report.catalogue import LEARNED_LOADS, Product
from flexsurr.workflow.study_plan import FieldPlan, Job, data_folder, digest, trials_of

RESPONSE_KINDS = ("free", "forced")
DRAWN_RESPONSES = (*RESPONSE_KINDS, "sustained")

# What the trajectories of a dataset depend on, apart from the structure, the variant and their numbers.
DATASET = (
    "seed",
    "reduction",
    "dataset.duration_s",
    "dataset.step_s",
    "dataset.initial_conditions",
    "dataset.integrator",
)
# What configurations depend on that are sampled without a simulation.
SAMPLED = ("reduction", "dataset.initial_conditions")
SCORE = (
    "seed",
    "reduction",
    "dataset.initial_conditions",
    "evaluation.duration_s",
    "evaluation.output_step_s",
    "evaluation.long_responses",
    "evaluation.reference_integrator",
    "evaluation.judging_integrator",
)
STATICS = ("reduction", "statics")
VALIDATION = (
    "reduction",
    "variants",
    "evaluation.load",
    "evaluation.validation_duration_s",
    "evaluation.validation_integrator",
)
EVALUATION = (
    "seed",
    "reduction",
    "dataset.initial_conditions",
    "evaluation.duration_s",
    "evaluation.output_step_s",
    "evaluation.simulations",
    "evaluation.load",
    "evaluation.longest_load_s",
    "evaluation.integrators",
    "evaluation.reference_integrator",
)
RESPONSES = (*EVALUATION, "evaluation.drawing_integrator", "evaluation.energy_integrator")
WATCH = (
    "seed",
    "reduction",
    "dataset.initial_conditions",
    "evaluation.simulations",
    "evaluation.duration_s",
)
LEARNED_LOAD = (
    "reduction",
    "evaluation.load",
    "evaluation.learned_load",
)
COST = (
    *EVALUATION,
    "evaluation.described_simulations",
    "evaluation.scipy_simulations",
    "evaluation.repeats",
)


class TrajectoryPlan(FieldPlan):
    """Every job of such a study. Raises ConfigurationError for a sweep whose combinations don't fit.

    Rules name a dataset by its folder, `data`: a variant, and the name of a further dataset.
    """

    source = "trajectories"

    def __init__(self, resolved: ResolvedStudy) -> None:
        study = resolved.study
        trials = trials_of(resolved.sweeps, study.sweeps, resolved.own_networks)
        if resolved.structure.gravity_m_s2 > 0.0:
            _check_potentials(study, trials)
        super().__init__(resolved.name, trials)
        self.resolved, self.variants = resolved, study.variants

    def dataset_of(self, sweep: str) -> str:
        """The name of the dataset that a sweep trains on."""
        return self.resolved.study.dataset_of(sweep)

    @property
    def rule_of_choice(self) -> Job:
        """The study's."""
        return self.resolved.study.selection.model_dump(mode="json")

    def shards(self, data: str) -> int:
        """Number of shards of one dataset."""
        return self._settings(data).dataset.shards

    def simulate(self, data: str, shard: int | str) -> Job:
        """One shard, by its number: trajectories `first` to `first + count − 1`."""
        dataset = self._settings(data).dataset
        first = int(shard) * dataset.trajectories_per_shard
        return {
            **self._dataset(data),
            "configuration": self._configuration(data),
            "first": first,
            "count": min(dataset.trajectories_per_shard, dataset.trajectories - first),
        }

    def manifest(self, data: str) -> Job:
        """The manifest of one dataset."""
        settings = self._settings(data)
        return {
            "study": self.name,
            "variant": _variant(data),
            "seed": settings.seed,
            "configuration": self._configuration(data),
            "shards": settings.dataset.shards,
            "trajectories": settings.dataset.trajectories,
            "split_by": settings.dataset.split_by,
            "training_fraction": settings.dataset.training_fraction,
        }

    def configurations(self, data: str) -> Job:
        """What stands in the place of a dataset: a structure, and ranges of its configurations."""
        return {**self.part(()), "part": values_of(self._settings(data), SAMPLED)}

    def ranges(self, data: str) -> str:
        """A hash of it, the same for what was so before."""
        return digest(self.configurations(data) | {"structure": self.resolved.structure.identity})

    def score(self, key: str) -> Job:
        """Held-out errors and long responses of one run."""
        return {**self.part(SCORE), "variant": self.runs[key].variant}

    def statics(self) -> Job:
        """Static deflection and natural frequencies."""
        also = [structure.model_dump(mode="json") for structure in self.resolved.frequencies_also_of]
        return {**self.part(STATICS), "frequencies_also_of": also}

    def validation(self) -> Job:
        """The reduced model against the full one."""
        return self.part(VALIDATION)

    def respond(self, variant: str) -> Job:
        """Responses and energies of the selected surrogates."""
        return {**self.part(RESPONSES), "variant": variant}

    def watch(self, variant: str) -> Job:
        """The free response of the selected surrogates, moving."""
        return {**self.part(WATCH), "study": self.name, "variant": variant}

    def rehearse(self, variant: str) -> Job:
        """What will be timed."""
        return {**self.part(EVALUATION), "variant": variant}

    def cost(self, variant: str) -> Job:
        """Wall times and errors of everything."""
        return {**self.part(COST), "study": self.name, "variant": variant}

    def learn_load(self, variant: str) -> Job:
        """The study's load, learned from configurations of one variant."""
        return {**self.part(LEARNED_LOAD), "study": self.name, "variant": variant}

    def load_data(self, variant: str) -> str:
        """The folder of the dataset that the load is learned from."""
        return data_folder(variant, self.resolved.study.evaluation.learned_load.dataset)

    @property
    def learns_load(self) -> bool:
        """Whether a map of η can tell the load's generalised forces: not those of a turning clamp."""
        return not turns_clamp(self.resolved.study.evaluation.load)

    @property
    def evaluation(self) -> dict[str, list[str]]:
        """The names of the files that its evaluation makes, by the rule that makes them."""
        made: dict[str, list[str]] = {
            "statics": ["statics", "frequencies", "shapes"],
            "validation": ["validation"],
        }
        made |= {"responses": [], "learn_load": [], "evaluate": []}
        for variant in self.variants:
            made["responses"] += [f"response-{variant}-{response}" for response in DRAWN_RESPONSES]
            made["responses"].append(f"energy-{variant}")
            if self.learns_load:
                made["learn_load"].append(f"learned_loads-{variant}")
            made["evaluate"] += [f"cost-{variant}-{response}" for response in RESPONSE_KINDS]
        return made

    def shows(self, product: Product) -> bool:
        """Whether a figure or table is made of this study: some are of some structures or loads alone."""
        made = self.learns_load or LEARNED_LOADS not in product.reads
        return made and super().shows(product) and product.shows(self.resolved.structure)

    def values_for(self, product: Product) -> Job:
        """The structure too, where a figure draws it."""
        return super().values_for(product) | (self._structure() if "structure" in product.reads else {})

    def _structure(self) -> Job:
        return {"structure": self.resolved.structure.model_dump(mode="json")}

    def part(self, keys: tuple[str, ...]) -> Job:
        """The structure, and the values of `keys` of the study."""
        return {**self._structure(), "part": values_of(self.resolved.study, keys)}

    def _dataset(self, data: str) -> Job:
        part = values_of(self._settings(data), DATASET)
        return {**self._structure(), "part": part, "study": self.name, "variant": _variant(data)}

    def _configuration(self, data: str) -> str:
        """A hash of all that the trajectories of a dataset depend on."""
        return digest(self._dataset(data) | {"structure": self.resolved.structure.identity})

    def _settings(self, data: str) -> Study:
        """The study as if the dataset in the folder `data` were its only one."""
        study = self.resolved.study
        dataset = study.datasets[data.partition("-")[2] or DEFAULT]
        return study.model_copy(update={"dataset": dataset, "seed": study.seed_of(dataset)})


def _check_potentials(study: Study, trials: Mapping[str, Sequence[Trial]]) -> None:
    """ConfigurationError, by its sweep's file, for a trial that knows no weight; the structure has one."""
    problems = [
        f"{study.sweeps[name]}: potential: none is not allowed for port_hamiltonian under gravity "
        f"(gravity_m_s2 in {study.structure}), which ½ qᵀKq does not know; allowed: [polynomial]"
        for name, of_sweep in trials.items()
        if any(trial.architecture == "port_hamiltonian" and _quadratic(trial) for trial in of_sweep)
    ]
    if problems:
        raise ConfigurationError(dict.fromkeys(problems))


def _quadratic(trial: Trial) -> bool:
    return getattr(trial, "potential", None) is None


def _variant(data: str) -> str:
    return data.partition("-")[0]
