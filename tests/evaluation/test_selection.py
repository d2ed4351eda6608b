"""What is chosen among runs."""

import itertools
import json

import pytest

from flexsurr.cli import selection
from flexsurr.evaluation.selection import choose, select, select_maps


def record(run, architecture="hnn", error=1.0, operations=64, variant="hamiltonian", **more):
    return {
        "run_id": run,
        "variant": variant,
        "status": "finished",
        "architecture": architecture,
        "operations": operations,
        "long_response_error_percent_worst": error,
        "validation_nmse": 1.0,
        "diverged": 0,
    } | more


RECORDS = [
    record("small", error=3.0, operations=16),
    record("best", error=0.1, operations=64, validation_nmse=1e-6),
    record("lowest loss", error=0.5, operations=64, validation_nmse=1e-12),
    record("large", error=0.2, operations=512),
    record("plain", "mlp", error=7.0, operations=66),
    record("other", error=9.0, variant="as_printed"),
    record("failed", status="failed", long_response_error_percent_worst=None),
    record("runs away", error=None, diverged=3),
    record("runs away later", error=0.01, diverged=1),
]


def test_the_best_of_each_architecture_by_the_long_response():
    selection = select(RECORDS)
    assert set(selection) == {"hamiltonian", "as_printed"}
    assert selection["hamiltonian"]["hnn"] == RECORDS[1]
    assert selection["hamiltonian"]["mlp"]["run_id"] == "plain"
    assert selection["as_printed"]["hnn"]["run_id"] == "other"


def test_the_pareto_set_is_what_none_beats():
    found = [r["run_id"] for r in select(RECORDS)["hamiltonian"]["pareto"]]
    assert found == ["small", "best"]


def test_under_a_limit_the_cheapest_that_keeps_it():
    selection = select([*RECORDS, record("cheap and plain", "mlp", error=8.0, operations=4)], 5.0)
    assert selection["hamiltonian"]["hnn"]["run_id"] == "small"
    # none of the others does: the most accurate
    assert selection["hamiltonian"]["mlp"]["run_id"] == "plain"


def test_of_all_one_is_chosen_by_the_same_rule():
    named = {"hnn": RECORDS[1], "mlp": RECORDS[4], "hnn_paper": RECORDS[0]}
    assert choose(named) == "hnn"
    assert choose(named, 5.0) == "hnn_paper"
    assert choose(named, 0.01) == "hnn"


def test_what_calls_python_is_the_dearest():
    python = record("python", "own", error=0.05, operations=None)
    chosen = select([*RECORDS, python], 5.0)["hamiltonian"]
    assert [entry["run_id"] for entry in chosen["pareto"]] == ["small", "best", "python"]
    assert choose({"own": python, "hnn": RECORDS[1]}, 5.0) == "hnn"


def test_order_does_not_matter():
    ties = [
        *RECORDS[:3],
        record("a tie", error=0.1, operations=64),
        record("cheaper tie", error=0.1, operations=60),
    ]
    for limit in (None, 0.2):
        results = [select(order, limit) for order in itertools.permutations(ties)]
        assert all(result == results[0] for result in results)
        assert results[0]["hamiltonian"]["hnn"]["run_id"] == "cheaper tie"


def test_nothing_to_choose_from():
    assert select([]) == {}
    assert select([RECORDS[6]]) == {}


def test_of_maps_each_label_has_its_choice_by_validation():
    records = [
        record("failed", label="network", status="failed", validation_nmse=1e-9),
        record("small", label="network", operations=16, validation_nmse=1e-3),
        record("better", label="network", operations=64, validation_nmse=1e-4),
        record("no number", label="linear", validation_nmse=None),
        record("baseline", label="linear"),
    ]
    for limit, network in ((None, "better"), (2e-3, "small"), (2e-4, "better"), (1e-5, "better")):
        chosen = select_maps(records, limit)
        assert {label: entry["run_id"] for label, entry in chosen.items()} == {
            "network": network,
            "linear": "baseline",
        }


@pytest.mark.parametrize(
    ("more", "found"),
    [
        ({"selection": {"error_at_most_percent": 0.1}}, lambda selected: selected["hamiltonian"]["hnn"]),
        ({"selection": {"nmse_at_most": 1e-6}, "maps": True}, lambda selected: selected["network"]),
    ],
)
def test_what_is_selected_says_by_which_rule(tmp_path, more, found):
    """The card of the champion tells it to its reader."""
    (tmp_path / "one").mkdir()
    one = record("one", study="cantilever", label="network")
    (tmp_path / "one/metrics.json").write_text(json.dumps(one))
    job = {"study": "cantilever", "sweeps": {"default": ["one"]}, **more}
    selection.select(job, tmp_path, tmp_path / "selected.json")
    entry = found(json.loads((tmp_path / "selected.json").read_text()))
    assert entry == one | {"chosen_by": more["selection"]}
