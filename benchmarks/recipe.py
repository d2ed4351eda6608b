"""What networks of the paper's own recipe do in its ten free and ten forced responses.

Run after  snakemake --cores 2 --configfile config/presets/paper.yaml :  python benchmarks/recipe.py

Errors are those of the tip over the peak of its displacement [%], so far: median and worst of the ten. The
energy is the reduced model's along the network's states, over the reference's, at the end; the amplitude is
the largest displacement of the tip in the last five seconds, over the reference's peak [%].
"""

import json
from pathlib import Path

import numpy as np

from flexsurr.beam import reduce, reduced_order
from flexsurr.config.settings import load
from flexsurr.evaluation.cases import evaluation_cases, under
from flexsurr.simulation import simulate
from flexsurr.surrogates import load_model

PROJECT = Path(__file__).parents[1]
FILES = ["config/config.yaml", "config/presets/paper.yaml"]
VARIANT = "as_printed"
TIMES = np.linspace(0.0, 30.0, 3001)
SOON_S = (2.0, 10.0)
LATE = TIMES >= 25.0


def responses(model, basis, study, kind):
    """The states (t, 2r) of each of the study's ten responses."""
    cases = evaluation_cases(basis, study, kind)
    integrator = study.evaluation.reference_integrator
    return [simulate(under(model, basis, case, "compiled"), TIMES, case.x0, integrator).x for case in cases]


def compared(exact, found, model):
    """Errors [%] within 2, 10 and 30 s, the energy over the reference's, late amplitudes [%] of both."""
    at_rest = model.tip(np.zeros(exact.shape[1]))
    displacement, other = model.tip(exact) - at_rest, model.tip(found) - at_rest
    peak = np.max(np.linalg.norm(displacement, axis=1))
    error = 100.0 * np.linalg.norm(other - displacement, axis=1) / peak
    within = [np.max(error[end >= TIMES]) for end in (*SOON_S, TIMES[-1])]
    late = [100.0 * np.max(np.linalg.norm(tip[LATE], axis=1)) / peak for tip in (other, displacement)]
    return [*within, model.energy(found[-1]) / model.energy(exact[-1]), *late]


def main() -> None:
    """Print a row for each structure, response and network."""
    configuration = load(PROJECT, FILES)
    runs = PROJECT / configuration.settings.results / "runs"
    fits = [json.loads(file.read_text()) for file in sorted(runs.glob("*/fit.json"))]
    for resolved in configuration.studies:
        basis = reduce(resolved.structure, resolved.study.reduction)
        model = reduced_order(basis, VARIANT, "compiled")
        for kind in ("free", "forced"):
            exact = responses(model, basis, resolved.study, kind)
            for fit in fits:
                if fit["study"] != resolved.name:
                    continue
                network = load_model(runs / fit["run_id"] / "weights.npz", "compiled")
                found = responses(network, basis, resolved.study, kind)
                rows = np.array([compared(*pair, model) for pair in zip(exact, found, strict=True)])
                print(f"{resolved.name}, {kind}: {fit['architecture']}, loss {fit['loss']}")
                for name, column in zip(("2 s", "10 s", "30 s"), rows[:, :3].T, strict=True):
                    print(f"    error within {name}: {np.median(column):.2g}, {np.max(column):.2g} %")
                print(f"    energy: {' '.join(f'{value:.3g}' for value in rows[:, 3])}")
                for name, column in zip(("amplitude", "reference"), rows[:, 4:].T, strict=True):
                    print(f"    {name}: {np.min(column):.2g} to {np.max(column):.2g} %", flush=True)


if __name__ == "__main__":
    main()
