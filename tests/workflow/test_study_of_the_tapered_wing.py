"""A structure of one's own from end to end: the tapered wing, to tables and figures."""

import json

import pandas as pd
import pytest

STUDY = "tapered_wing"
SCIPY = {"method": "scipy_radau", "step_s": None}
"""Of SciPy's integrators nothing has to be compiled but the right-hand sides."""


@pytest.fixture(scope="module")
def wing(make_project):
    """Its study, with little of everything."""
    project = make_project()
    project.tell_no_page()
    preset, sweep = "config/presets/quick.yaml", f"config/sweeps/{STUDY}.yaml"
    project.change(preset, "studies", [STUDY])
    project.change(sweep, "spaces.0.degree", [4])
    project.change(sweep, "spaces.1.epochs", [2])
    settings = {
        "dataset": {"trajectories": 6, "trajectories_per_shard": 6, "duration_s": 0.1, "integrator": SCIPY},
        "evaluation": {
            "simulations": 1,
            "duration_s": 0.03,
            "output_step_s": 0.01,
            "repeats": 1,
            "long_responses": 1,
            "validation_duration_s": 0.01,
            "longest_load_s": 0.1,
            "integrators": [],
            **{
                f"{role}_integrator": SCIPY
                for role in ("reference", "judging", "drawing", "energy", "validation")
            },
        },
        "statics": {"tip_loads_N": [0, 500]},
    }
    project.change(preset, "overrides", {STUDY: settings})
    project.run_well()
    return project


def test_every_figure_and_table_is_there(wing):
    for name in wing.plan.figures(STUDY):
        assert (wing.results / "figures" / STUDY / f"{name}.png").read_bytes().startswith(b"\x89PNG")
    for name in wing.plan.tables(STUDY):
        assert (wing.results / "tables" / STUDY / f"{name}.html").is_file()


def test_its_weight_is_learned_and_its_costs_are_known(wing):
    (selected,) = json.loads((wing.results / "selected" / f"{STUDY}.json").read_text()).values()
    assert {"mlp", "port_hamiltonian"} <= set(selected)
    cost = pd.read_csv(wing.results / "tables" / "cost.csv")
    assert set(cost["response"]) == {"free", "forced"}
    assert {"rom", "mlp", "port_hamiltonian"} <= set(cost["model"])
    good = cost[(cost["model"] == "port_hamiltonian") & (cost["response"] == "free")]
    assert (good["tip_error_percent"] < 1.0).all()
    frequencies = pd.read_csv(wing.results / "tables" / "natural_frequencies.csv")
    assert frequencies["fom_rad_s"].head(3).round(1).tolist() == [16.9, 61.7, 67.4]  # as its study says
