"""What is timed has been rehearsed: nothing is compiled, and nothing loaded, while the clock runs."""

import pytest
from numba.core.dispatcher import Dispatcher

from flexsurr.evaluation.cost import cost_table
from flexsurr.evaluation.rehearsal import REHEARSED_COLUMNS, rehearsed
from flexsurr.simulation import machine_code

ROW = ["model", "implementation", "integrator"]


@pytest.mark.parametrize("response", ["free", "forced"])
def test_every_compiled_row_is_rehearsed_and_then_compiles_nothing(
    study, basis, fitted, response, monkeypatch
):
    given = study, basis, "hamiltonian", response, {"polynomial": fitted}
    found = rehearsed(*given)
    compiled = []
    monkeypatch.setattr(Dispatcher, "compile", lambda dispatcher, sig: compiled.append((dispatcher, sig)))
    timed = cost_table("short", *given)
    assert compiled == []
    timed = timed[timed["implementation"] == "compiled"]
    assert tuple(found.columns) == REHEARSED_COLUMNS
    assert set(map(tuple, found[ROW].to_numpy())) == set(map(tuple, timed[ROW].to_numpy()))
    assert (found["wall_s"] > 0.0).all()
    assert (found["response"] == response).all()


def test_what_another_process_compiles_is_left_for_the_end(study, basis, monkeypatch):
    from flexsurr.evaluation import rehearsal

    first_steps, calls = rehearsal.first_steps, []

    def busy(setup, *given):
        calls.append(str(setup))
        if len(calls) == 1:
            raise machine_code.CompiledElsewhere(str(setup))
        first_steps(setup, *given)

    monkeypatch.setattr(rehearsal, "first_steps", busy)
    found = rehearsed(study, basis, "hamiltonian", "free", {})
    assert calls[0] == calls[-1]
    assert len(calls) == len(found) + 1
    assert " ".join(found[ROW].iloc[-1]) == calls[0]
