"""The surrogates of a sweep against the compiled reduced model they stand for: cost and tip error over 30 s.

    python benchmarks/chosen.py

Of the study's structure and of one of 160 elements, whose reduced model costs more while a surrogate's cost
stays; both start from the same shapes and velocities. All are fitted without a simulation, judged by the
study's long responses, and timed in turns with the reduced model over one of them, by the study's first
integrator and its samples. Marked are those that the study's rule chooses, of all and of the networks.
"""

import tempfile
from pathlib import Path

import numpy as np
import yaml
from timing import compare

from flexsurr.beam import reduce, reduced_order
from flexsurr.config.structure import Structure
from flexsurr.config.study import Study
from flexsurr.config.trial import trial_of
from flexsurr.evaluation.operations import operations
from flexsurr.evaluation.scores import long_response_errors, long_responses
from flexsurr.evaluation.selection import COST, ERROR, choose
from flexsurr.simulation import simulate
from flexsurr.surrogates import compiled
from flexsurr.training import fit
from flexsurr.training.configuration_samples import configuration_samples

ROOT = Path(__file__).parents[1]
VARIANT, REPEATS = "hamiltonian", 15
IN_A_TURN = 5
"""Simulations: the first finds the caches as another model has left them."""
ELEMENTS = {"cantilever": (10, 160), "wing": (16, 160)}
CONFIGURATIONS = {"cantilever": 500, "wing": 2000}
SQUARES = {"optimiser": "least_squares"}
EVEN = {"architecture": "even_hnn", "epochs": 400, "patience": 60}
PASSIVE = {"architecture": "port_hamiltonian"}
OF_MASS = PASSIVE | {"epochs": 300}
TRIALS = {
    "cantilever": {
        **{
            f"polynomial, degree {n}": {"architecture": "polynomial", "degree": n} | SQUARES
            for n in (4, 6, 10)
        },
        **{
            f"even HNN, {n} {name}": EVEN | {"hidden": (n,), "activation": name}
            for n in (4, 8)
            for name in ("half_log", "atan")
        },
        "even HNN, 4 cube": EVEN | {"hidden": (4,), "activation": "cube"},
        "HNN, 16 half_log": {"architecture": "hnn", "hidden": (16,), "activation": "half_log", "epochs": 400},
    },
    "wing": {
        **{f"degree {n}": PASSIVE | {"degree": n} | SQUARES for n in (4, 6, 8)},
        **{f"sparse, degree {n}": PASSIVE | {"degree": n, "terms": "sparse"} | SQUARES for n in (4, 6)},
        "network of entries, 16 atan": OF_MASS
        | {"mass_matrix": "entries", "hidden": (16,), "activation": "atan"},
        **{
            f"mirrored network, {n} squareplus": OF_MASS
            | {"mass_matrix": "mirrored", "hidden": (n,), "activation": "squareplus"}
            for n in (8, 12)
        },
    },
}
REFERENCE = "reduced model"


def study_of(name: str, finer: float) -> Study:
    """The study for a chain of `finer` times as many elements: the same shape is less of a unit-norm mode."""
    study = Study.model_validate(yaml.safe_load((ROOT / f"config/studies/{name}.yaml").read_text()))
    ranges = study.dataset.initial_conditions
    of_q, of_p = finer**-0.5, finer**0.5
    scaled = {name: of_q * getattr(ranges, name) for name in ("q_min_deg", "q_max_deg")}
    scaled |= {name: of_p * getattr(ranges, name) for name in ("p_min_kg_m2_s", "p_max_kg_m2_s")}
    dataset = study.dataset.model_copy(update={"initial_conditions": ranges.model_copy(update=scaled)})
    return study.model_copy(update={"dataset": dataset})


def of_structure(name: str, elements: int) -> None:
    study = study_of(name, elements / ELEMENTS[name][0])
    structure = Structure(**yaml.safe_load((ROOT / study.structure).read_text()))
    basis = reduce(structure.model_copy(update={"elements": elements}), study.reduction)
    samples = configuration_samples(basis, VARIANT, study.dataset.initial_conditions, CONFIGURATIONS[name])
    references = long_responses(study, basis, VARIANT)
    integrator = study.evaluation.integrators[0]
    start, t = references[0].case.x0, references[0].t
    models, errors = {REFERENCE: reduced_order(basis, VARIANT, "compiled")}, {}
    for label, settings in TRIALS[name].items():
        trial = trial_of(**settings, configurations=CONFIGURATIONS[name])
        with tempfile.TemporaryDirectory() as folder:
            surrogate = fit(trial, samples, Path(folder)).surrogate
        models[label] = compiled(surrogate)
        found = long_response_errors(study, basis, VARIANT, surrogate, references)
        error = found[ERROR]
        errors[label] = np.inf if error is None else error

    def simulated(model):
        for _ in range(IN_A_TURN):
            simulate(model, t, start, integrator)

    runs = {label: lambda model=model: simulated(model) for label, model in models.items()}
    work, parts = f"30 s of the {name}, N = {elements}", {k: error / 100.0 for k, error in errors.items()}
    costs = {label: operations(model, start) for label, model in models.items()}
    marks = chosen(name, errors, costs, study.selection.error_at_most_percent)
    more = {label: {"operations": cost, "mark": marks.get(label)} for label, cost in costs.items()}
    timings = compare(work, runs, REPEATS, counts=IN_A_TURN, errors=parts, more=more)
    print(f"\n{name}, N = {elements}, {integrator.label}")
    print(f"{'':<32}{'operations':>12}{'30 s':>18}{'times faster':>20}{'worst tip error %':>20}")
    for label, timing in timings.items():
        # the ratio of each turn, whose median and spread are kept
        faster, spread = 1.0 / timing.ratio, timing.ratio_spread / timing.ratio**2
        shown = f"{faster:.1f} ± {spread:.1g}"
        error = f"{errors.get(label, 0.0):.2g}"
        print(f"{label:<32}{costs[label]:>12}{timing!s:>18}{shown:>20}{error:>20} {marks.get(label, '')}")


def chosen(
    name: str, errors: dict[str, float], costs: dict[str, int | None], limit: float | None
) -> dict[str, str]:
    """By label, what the study's rule chooses: of all, and of the networks."""
    records = {label: {ERROR: errors[label], COST: costs[label], "run_id": label} for label in errors}
    networks = {label: record for label, record in records.items() if "hidden" in TRIALS[name][label]}
    return {choose(networks, limit): "of the networks", choose(records, limit): "chosen"}


def main() -> None:
    for name, sizes in ELEMENTS.items():
        for elements in sizes:
            of_structure(name, elements)


if __name__ == "__main__":
    main()
