"""What figures and tables there are, and what each reads. Planning them imports nothing that makes them.

A product says what it `reads`, in the order of its function's arguments:

| read | is |
|---|---|
| structure | the study's `Structure` |
| metrics | one row for each run of the study: its metrics.json |
| sweeps | the run_ids of each sweep of the study |
| selection | the study's rule of choice |
| relatives | the same of every study of the same structure |
| history | all runs' history.parquet, with a column run_id |
| free_modes, lattice, doublet | of the study's aircraft: modes, vortex lattice, times of a doublet |
| lattice_operations | what a call of each form of that lattice takes; None of a study without an aircraft |
| anything else | results/evaluation/<study>/<it>.parquet; a * stands for every file that fits, concatenated |

A figure may show what only some structures have: `Product.shows` says of which it is made.
"""

from collections.abc import Callable
from dataclasses import dataclass

from flexsurr.config.structure import Structure


def any_structure(structure: Structure) -> bool:
    """True."""
    return True


def cantilever(structure: Structure) -> bool:
    """Whether it is the paper's cantilever (its Figs. 8 to 10, 12 and 13)."""
    return structure.name == "cantilever"


def wing(structure: Structure) -> bool:
    """Whether it is the paper's wing (its Figs. 14 and 15)."""
    return structure.name == "wing"


def bends(structure: Structure) -> bool:
    """Whether it has a joint that bends."""
    return not {"in_plane", "out_of_plane"}.isdisjoint(structure.joints)


def lifts(structure: Structure) -> bool:
    """Whether its tip can move along z: the static loads, and the two models' comparison, are along z."""
    return any(abs(axis[2]) > 1e-9 for axis in structure.felt_axes)


def conservative(structure: Structure) -> bool:
    """Whether nothing of the structure is damped."""
    return not structure.dissipates


def damped(structure: Structure) -> bool:
    """Whether something of the structure is damped."""
    return structure.dissipates


SIMULATED = ("trajectories",)
FILES = ("files",)
SAMPLES = ("samples",)
MODES = ("modes",)
OF_FIELDS = (*SIMULATED, *FILES)
EVERY_SOURCE = (*OF_FIELDS, *SAMPLES)

LEARNED_LOADS = "learned_loads-*"
"""What is read of learned loads."""

OF_AIRCRAFT = frozenset({"free_modes", "lattice", "doublet", "lattice_operations"})
"""What is read of the aircraft of a study of samples."""


@dataclass(frozen=True)
class Product:
    """A figure or a table: its title, what its function reads, and of which studies it is made.

    `sources`: where the data of these studies come from; `shows`: which structures they are of.
    """

    title: str
    reads: tuple[str, ...] = ()
    shows: Callable[[Structure], bool] = any_structure
    sources: tuple[str, ...] = SIMULATED


FIGURES: dict[str, Product] = {
    "figure_03": Product("Discretisation", ("structure",), bends),
    "figure_04": Product("Frames and position vectors", ("structure",)),
    "figure_05": Product("Multilayer perceptron"),
    "figure_06": Product("Hamiltonian neural network", shows=conservative),
    "figure_07": Product("Dissipative Hamiltonian neural network", shows=damped),
    "figure_08": Product("Tip under static loads", ("statics",), cantilever),
    "figure_09": Product("Tip under a harmonic load", ("validation",), cantilever),
    "figure_10": Product("Free response", ("response-*-free",), cantilever),
    "figure_11": Product("Augmented surrogate"),
    "figure_12": Product("Response under a harmonic load", ("response-*-sustained",), cantilever),
    "figure_13": Product("Total energy", ("energy-*",), cantilever),
    "figure_14": Product("Free response", ("response-*-free",), wing),
    "figure_15": Product("Response to lift and drag", ("response-*-sustained",), wing),
    "mode_shapes": Product("Mode shapes", ("shapes",)),
    "static_shapes": Product("Shapes under static loads", ("shapes",), lifts),
    "static_deflection": Product("Static deflection, and its errors", ("statics",), lifts),
    "reduced_against_full": Product("Reduced against full order", ("validation",), lifts),
    "free_response_of_every_model": Product("Free response of every model", ("structure", "response-*-free")),
    "forced_response_of_every_model": Product(
        "Forced response of every model", ("structure", "response-*-forced")
    ),
    "energy_drift": Product("Drift of energy, models and integrators", ("energy-*",), conservative),
    "energy_decay": Product("Total energy, free and forced", ("energy-*",), damped),
    "architecture_errors": Product("Errors by architecture", ("relatives",), damped),
    "cost_accuracy": Product("Cost against accuracy", ("cost-*-*",)),
    "rollouts": Product("Rollouts against held-out trajectories", ("rollout_curves",), sources=FILES),
    "phase_plane": Product("Rollouts in the phase plane", ("rollout_curves",), sources=FILES),
    "training_loss": Product("Training loss against wall time", ("history", "metrics"), sources=OF_FIELDS),
    "training_epochs": Product("Training loss against epochs", ("history", "metrics"), sources=OF_FIELDS),
    "trials": Product("Trials: settings against error", ("sweeps", "metrics"), sources=EVERY_SOURCE),
    "pareto": Product(
        "Cost against error of every trial",
        ("selection", "lattice_operations", "metrics"),
        sources=EVERY_SOURCE,
    ),
    "figure_16": Product("The airliner and its panels", ("free_modes", "lattice"), sources=SAMPLES),
    "figure_17": Product("Distribution of mass", ("free_modes",), sources=SAMPLES),
    "figure_18": Product("Eigenvalues in trim", ("modes",), sources=SAMPLES),
    "figure_19": Product("Elevator doublet: longitudinal states", ("doublets", "doublet"), sources=SAMPLES),
    "figure_20": Product(
        "Elevator doublet: lateral-directional states", ("doublets", "doublet"), sources=SAMPLES
    ),
    "figure_21": Product(
        "Elevator doublet: modal displacements", ("doublets", "doublet", "elastic_modes"), sources=SAMPLES
    ),
    "aileron_doublet": Product("Aileron doublet", ("doublets", "doublet", "elastic_modes"), sources=SAMPLES),
    "rudder_doublet": Product("Rudder doublet", ("doublets", "doublet", "elastic_modes"), sources=SAMPLES),
    "elastic_modes": Product("Elastic modes", ("free_modes", "elastic_modes"), sources=SAMPLES),
    "coefficient_errors": Product("Error against each input", ("errors",), sources=SAMPLES),
    "crossover": Product("Which surrogate stands for how many modes", ("rivals-*",), sources=MODES),
}

TABLES: dict[str, Product] = {
    "static_tip": Product("Tip under static loads", ("statics",), lifts),
    "natural_frequencies": Product("Natural frequencies", ("frequencies",)),
    "sweeps": Product("Sweeps, and what came of them", ("sweeps", "metrics"), sources=EVERY_SOURCE),
    "training": Product("Training runs", ("metrics",), sources=EVERY_SOURCE),
    "architectures": Product("Every architecture in every setting", ("metrics",), sources=OF_FIELDS),
    "seeds": Product("Mean and spread over seeds", ("metrics",), sources=OF_FIELDS),
    "cost": Product("Cost and accuracy", ("cost-*",), sources=(*SIMULATED, *SAMPLES)),
    "learned_loads": Product("Learned loads", (LEARNED_LOADS,)),
    "rollout_errors": Product("Errors of rollouts", ("rollouts",), sources=FILES),
    "rollout_cost": Product("Cost of rollouts", ("rollout_cost",), sources=FILES),
    "airliner_accuracy": Product("Accuracy of the coefficients", ("accuracy",), sources=SAMPLES),
    "airliner_elastic_modes": Product(
        "Elastic modes and their numbers in the paper", ("elastic_modes",), sources=SAMPLES
    ),
    "airliner_modes": Product("Eigenvalues in trim", ("modes",), sources=SAMPLES),
    "airliner_left_out_modes": Product(
        "What the modes left out of the aerodynamics change", ("left_out_modes",), sources=SAMPLES
    ),
    "airliner_cost": Product("Cost of ninety flights", ("flight_cost",), sources=SAMPLES),
    "airliner_limits": Product("States beyond the network's limits", ("limits",), sources=SAMPLES),
    "crossover": Product("What stands for how many modes", ("rivals-*",), sources=MODES),
}
