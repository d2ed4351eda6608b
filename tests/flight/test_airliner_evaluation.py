"""What the airliner's models are compared by: flights, errors, limits, modes, costs; and its figures."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from flexsurr.config.aerodynamics import PanelCounts, load_feature_limits
from flexsurr.config.flight import DoubletTimes, FlightCondition, FlightSettings, RandomFlights
from flexsurr.evaluation.airliner_cost import (
    TORCH,
    airliner_cost,
    as_cost_rows,
    exceedance_summary,
    fly_all,
)
from flexsurr.evaluation.airliner_flights import (
    MOVED,
    Flight,
    flights_in,
    flown,
    history,
    limit_exceedances,
    outputs,
    outputs_in,
    peak_errors,
    random_flights,
)
from flexsurr.evaluation.airliner_models import ONE_MACH, REFERENCE, Airliner, lattice_operations, lattices
from flexsurr.evaluation.airliner_modes import airliner_modes, elastic_modes, left_out_modes
from flexsurr.evaluation.airliner_references import reference_flights
from flexsurr.evaluation.columns import COST_COLUMNS, MODE_COLUMNS, REBUILT
from flexsurr.evaluation.operations import counted_outputs
from flexsurr.flight.airliner import flexible_airframe
from flexsurr.flight.linear_aerodynamics import linear_aerodynamics
from flexsurr.flight.trim import TrimNotFound, trim
from flexsurr.report.catalogue import FIGURES, SAMPLES
from flexsurr.report.figures import DRAW
from flexsurr.report.style import save

CRUISE = FlightCondition(mach=0.7, altitude_m=10000.0)
LIMITS = load_feature_limits(Path(__file__).resolve().parents[2] / "config/aircraft/gnba_limits.yaml")


@pytest.fixture(scope="module")
def airliner(gnba_modes):
    settings = FlightSettings(
        duration_s=1.0,
        doublet=DoubletTimes(start_s=0.2, middle_s=0.6, end_s=0.9),
        random_flights=RandomFlights(of_each_doublet=1, rebuild_flights=1, frozen_flights=2),
    )
    coarse = PanelCounts(wing=(10, 2), horizontal_tail=(4, 2), vertical_tail=(4, 2))
    return Airliner(settings, LIMITS, gnba_modes, flexible_airframe(gnba_modes, coarse))


@pytest.fixture(scope="module")
def surrogate(gnba_derivatives):
    about, value, slopes = gnba_derivatives.kernel
    return linear_aerodynamics(about, value, 1.01 * slopes)


@pytest.fixture(scope="module")
def trims(airliner, gnba_derivatives, surrogate):
    return [trim(airliner.flying(mapping), CRUISE) for mapping in (gnba_derivatives, surrogate)]


def references(airliner, aerodynamics, flights):
    """What `reference_flights` would have with other aerodynamics."""
    starts = [trim(airliner.flying(aerodynamics), flight.condition) for flight in flights]
    runs = [flown(start, flight, airliner.settings) for start, flight in zip(starts, flights, strict=True)]
    return pd.concat([history(REFERENCE, *pair) for pair in zip(flights, runs, strict=True)])


def anywhere(condition: FlightCondition) -> bool:
    return True


def test_random_flights_are_each_doublet_as_often_within_limits_whatever_their_number():
    settings = FlightSettings()
    flights = random_flights(settings, LIMITS, anywhere)
    assert len(flights) == 90
    assert pd.Series([flight.control for flight in flights]).value_counts().tolist() == [30, 30, 30]
    drawn = np.array([(f.condition.mach, f.condition.altitude_m, f.amplitude_deg) for f in flights])
    assert np.all((drawn[:, 0] >= LIMITS.mach.low) & (drawn[:, 0] <= LIMITS.mach.high))
    assert np.all((drawn[:, 1] >= LIMITS.altitude_m.low) & (drawn[:, 1] <= LIMITS.altitude_m.high))
    assert np.all((np.abs(drawn[:, 2]) >= 1.0) & (np.abs(drawn[:, 2]) <= 6.0))
    # all of it, not a part
    assert np.all(np.ptp(drawn, axis=0) > [0.23, 4600.0, 11.0])
    fewer = FlightSettings(random_flights=RandomFlights(of_each_doublet=2))
    assert random_flights(fewer, LIMITS, anywhere) == flights[:6]


def test_conditions_without_a_trim_are_drawn_anew():
    settings = FlightSettings()
    fast = random_flights(settings, LIMITS, lambda condition: condition.mach > 0.7)
    assert len(fast) == 90
    assert min(flight.condition.mach for flight in fast) > 0.7
    with pytest.raises(TrimNotFound, match="none of 200 conditions within the limits has a trim"):
        random_flights(settings, LIMITS, lambda condition: False)
    timid = FlightSettings(random_flights=RandomFlights(least_deg=6.0))
    with pytest.raises(ValueError, match="elevator: limits of 6° leave no amplitude of 6°"):
        random_flights(timid, LIMITS, anywhere)


def test_a_flight_is_its_own_reference_and_errors_are_in_percent_of_the_peak(airliner, trims):
    exact, found = (flown(start, Flight(0, "elevator", CRUISE, 3.0), airliner.settings) for start in trims)
    names = MOVED["elevator"]
    assert set(peak_errors(outputs(exact), outputs(exact), names).values()) == {0.0}
    errors = peak_errors(outputs(exact), outputs(found), names)
    assert tuple(errors) == names
    q = np.degrees(exact.x[:, 10])
    assert errors["q_deg_s"] == pytest.approx(
        100.0 * np.abs(np.degrees(found.x[:, 10]) - q).max() / np.abs(q - q[0]).max()
    )
    assert 0.0 < errors["q_deg_s"] < 10.0
    still = {"p_deg_s": np.zeros(3)}
    assert np.isnan(peak_errors(still, still, ["p_deg_s"])["p_deg_s"])
    assert np.isnan(peak_errors(outputs(exact), {"q_deg_s": np.zeros(2)}, ["q_deg_s"])["q_deg_s"])
    assert outputs(exact)["airspeed_m_s"][0] == pytest.approx(np.linalg.norm(exact.x[0, 6:9]))


def test_what_is_written_of_flights_tells_them_and_what_they_are_compared_by(airliner, trims):
    flights = [Flight(4, "rudder", CRUISE, -1.3), Flight(0, "elevator", CRUISE, 3.0)]
    runs = [flown(trims[0], flight, airliner.settings) for flight in flights]
    written = pd.concat([history("a", *pair) for pair in zip(flights, runs, strict=True)])
    assert flights_in(written) == flights
    read = outputs_in(written)
    assert set(read) == {("a", 4), ("a", 0)}
    for flight, run in zip(flights, runs, strict=True):
        exact = outputs(run)
        assert set(read["a", flight.number]) == {name for names in MOVED.values() for name in names}
        for name, values in read["a", flight.number].items():
            np.testing.assert_array_equal(values, exact[name])


def test_states_beyond_the_limits_of_training_are_counted_for_each_input(airliner, trims):
    start = trims[0]
    flight = Flight(7, "elevator", CRUISE, 3.0)
    run = flown(start, flight, airliner.settings)
    low, high = np.full(25, -1e6), np.full(25, 1e6)
    nowhere = limit_exceedances(start, flight, run, airliner.settings, low, high)
    assert nowhere["outside"].sum() == 0
    high[8] = np.radians(2.0)  # the left elevator's, which reaches 3 degrees
    frame = limit_exceedances(start, flight, run, airliner.settings, low, high).set_index("input")
    times = airliner.settings.doublet
    up = (run.t >= times.start_s) & (run.t < times.middle_s)
    assert frame.loc["delta_e_left", "outside"] == np.count_nonzero(up)
    assert frame["outside"].sum() == frame.loc["delta_e_left", "outside"]
    summary = exceedance_summary(frame.reset_index()).set_index("input")
    assert summary.loc["delta_e_left", "flights_outside"] == 1
    assert summary.loc["delta_e_right", "flights_outside"] == 0


def test_modes_of_two_aerodynamics_are_matched_by_name(trims):
    frame = airliner_modes(*trims)
    assert tuple(frame.columns[:5]) == MODE_COLUMNS
    assert len(frame) == 13
    same = airliner_modes(trims[0], trims[0])
    assert same["error_percent"].max() == 0.0
    exact = frame.set_index("mode").loc["short period"]
    found = complex(exact["surrogate_real"], exact["surrogate_imag"])
    reference = complex(exact["reference_real"], exact["reference_imag"])
    assert exact["error_percent"] == pytest.approx(100.0 * abs(found - reference) / abs(reference))
    assert 0.1 < exact["error_percent"] < 5.0


def test_modes_left_out_of_the_aerodynamics_gain_damping_where_it_knows_them(airliner):
    frame = left_out_modes(airliner).set_index("mode")
    assert set(frame.index) == {
        *("short period", "phugoid", "dutch roll", "roll", "spiral"),
        *(f"elastic {k}" for k in range(1, 7)),
    }
    omega = airliner.modes.omega_rad_s
    for k in (3, 4):
        row = frame.loc[f"elastic {k}"]
        assert row["without_real"] == pytest.approx(-0.02 * omega[k - 1], rel=1e-5)
        assert row["with_real"] < row["without_real"]
    assert frame.loc["short period", "change_percent"] < 5.0


def test_costs_are_relative_to_each_lattice_over_the_flights_both_flew(airliner, gnba_derivatives, surrogate):
    forms = {
        "vlm_rebuild": gnba_derivatives,
        REFERENCE: gnba_derivatives,
        "network": lambda condition: surrogate,
    }
    limits = (np.full(25, -1e6), np.full(25, 1e6))
    drawn = random_flights(airliner.settings, LIMITS, lambda condition: condition.mach > 0.65)
    flights, left = fly_all(airliner, forms, references(airliner, gnba_derivatives, drawn), limits, surrogate)
    number = {REFERENCE: 3, "network": 3, TORCH: 3, "vlm_rebuild": 1}
    assert flights["model"].value_counts().to_dict() == number
    timed = flights[flights["wall_s"].notna()]
    assert timed["model"].value_counts().to_dict() == number | {REFERENCE: 2}
    assert flights["completed"].all()
    assert left["outside"].sum() == 0
    table = airliner_cost(flights)
    rows = as_cost_rows(table, "exact", 0.005)
    assert tuple(rows.columns) == COST_COLUMNS
    assert set(rows["integrator"]) == {"rk4(h=0.005)"}
    assert rows["relative_to_described_percent"].tolist() == table["relative_to_vlm_rebuild_percent"].tolist()
    cost = table.set_index("model")
    walls = flights.pivot(index="flight", columns="model", values="wall_s")
    of_the_frozen = walls[REFERENCE].fillna(walls[REFERENCE].mean())
    expected = (100.0 * walls["network"] / of_the_frozen).mean()
    assert cost.loc["network", f"relative_to_{REFERENCE}_percent"] == pytest.approx(expected)
    assert cost.loc["network", "vlm_rebuild_flights"] == 1
    assert cost.loc["network", f"{REFERENCE}_flights"] == 2
    assert cost.loc[REFERENCE, f"relative_to_{REFERENCE}_percent"] == 100.0
    assert cost.loc[REFERENCE, "wall_s_mean"] == pytest.approx(walls[REFERENCE].mean())
    everywhere = (100.0 * walls["network"] / walls["vlm_rebuild"].mean()).mean()
    assert cost.loc["network", "relative_to_vlm_rebuild_percent"] == pytest.approx(everywhere)
    assert cost.loc["network", "paper_percent"] == 0.995
    assert cost.loc[TORCH, "paper_percent"] == 55.0
    in_torch = rows[rows["implementation"] == "torch"]
    assert in_torch["model"].tolist() == ["network"]
    # it flies what the compiled one does, so that they err alike
    errors = cost["worst_error_percent"]
    assert errors[TORCH] == pytest.approx(errors["network"], rel=1e-4)
    # measured on the first flight alone, and a part of the whole
    assert flights["aerodynamics_percent"].notna().sum() == 4
    assert np.all((cost["aerodynamics_percent"] > 0.0) & (cost["aerodynamics_percent"] < 150.0))
    assert cost.loc["network", "worst_error_percent"] > cost.loc["network", "median_error_percent"] > 0.0
    assert cost.loc["vlm_rebuild", "worst_error_percent"] == 0.0  # the same aerodynamics as the reference


def test_a_form_of_the_lattice_that_is_not_timed_errs_all_the_same(airliner, gnba_derivatives, surrogate):
    flights = [Flight(number, "elevator", CRUISE, 3.0) for number in range(3)]
    known = references(airliner, gnba_derivatives, flights)
    known = pd.concat([known, references(airliner, surrogate, flights).assign(model=ONE_MACH)])
    frame, _ = fly_all(airliner, {ONE_MACH: surrogate}, known)
    assert frame["wall_s"].notna().tolist() == [True, True, False]
    assert frame["completed"].all()
    errors = frame["q_deg_s_error_percent"]
    assert 0.0 < errors.min() == pytest.approx(errors.max(), rel=1e-9)


def test_a_flight_without_a_trim_is_left_out(airliner, gnba_derivatives):
    there = Flight(0, "rudder", CRUISE, 2.0)
    nowhere = replace(there, condition=FlightCondition(mach=0.3, altitude_m=11000.0))
    known = references(airliner, gnba_derivatives, [there]).assign(mach=0.3, altitude_m=11000.0)
    assert flights_in(known) == [nowhere]
    flights, _ = fly_all(airliner, {"network": gnba_derivatives}, known)
    assert flights.empty


def test_references_are_every_random_flight_with_both_frozen_lattices_each_from_its_trim(airliner):
    settings = airliner.settings
    found = reference_flights(airliner, "exact")
    flights = flights_in(found)
    assert [flight.control for flight in flights] == ["elevator", "aileron", "rudder"]
    assert set(outputs_in(found)) == {(model, n) for model in (REFERENCE, ONE_MACH) for n in range(3)}
    exact = lattices(airliner, with_rebuild=False)[REFERENCE]
    for flight in flights:
        start = trim(airliner.flying(exact), flight.condition, settings.limits)
        expected = outputs(flown(start, flight, settings))
        for name, values in outputs_in(found)[REFERENCE, flight.number].items():
            np.testing.assert_array_equal(values, expected[name])


def test_a_few_panels_tell_what_the_whole_lattice_takes(airliner):
    found = lattice_operations(airliner)
    n = len(airliner.airframe.lattice)
    u = np.zeros(25)
    u[0] = 0.7
    for name, form in lattices(airliner).items():
        by_lapack = 2 / 3 * n**3 + 2 * n**2 if name == REBUILT else 0
        assert found[name] == pytest.approx(counted_outputs(form, u)[1] + by_lapack, rel=0.02)
    assert found["quadratic"] < found[ONE_MACH] < found[REFERENCE] < found[REBUILT]


def test_elastic_modes_are_named_by_what_moves_and_numbered_as_in_the_paper(airliner):
    frame = elastic_modes(airliner).set_index("mode")
    assert frame.loc[1, "name"] == "symmetric wing bending"
    assert frame.loc[3, "name"] == "symmetric engine nodding"
    assert frame.loc[4, "name"] == "antisymmetric lateral fuselage bending"
    assert np.all((frame["share_percent"] > frame["also_percent"]) & (frame["share_percent"] < 100.0))
    # 1, 6, 7 are symmetric in the paper, 2, 5, 8 are not; the third and fourth are left out of both
    of_the_paper = frame["paper_mode"].dropna()
    assert of_the_paper.to_dict() == {1: 1, 2: 2, 5: 6, 6: 5, 7: 8, 8: 7}
    assert set(of_the_paper[frame["symmetric"]]) == {1, 6, 7}
    other = replace(airliner, settings=airliner.settings.model_copy(update={"aerodynamic_modes": (1, 2, 5)}))
    assert elastic_modes(other)["paper_mode"].isna().all()


def test_figures_are_drawn(airliner, trims, tmp_path):
    histories = []
    for control in ("elevator", "aileron", "rudder"):
        for name, start in zip((REFERENCE, "network"), trims, strict=True):
            run = flown(start, Flight(0, control, CRUISE, 3.0), airliner.settings)
            histories.append(pd.DataFrame({"model": name, "control": control, "t_s": run.t, **outputs(run)}))
    shown = {
        "free_modes": airliner.modes,
        "lattice": airliner.airframe.lattice,
        "doublet": airliner.settings.doublet,
        "modes": airliner_modes(*trims),
        "doublets": pd.concat(histories),
        "elastic_modes": elastic_modes(airliner),
    }
    figures = {
        name: DRAW[name](*(shown[read] for read in product.reads))
        for name, product in FIGURES.items()
        if product.sources == SAMPLES and name != "coefficient_errors"
    }
    for figure in figures.values():
        figure.canvas.draw()
    assert all(path.stat().st_size > 10_000 for path in save(figures["figure_18"], tmp_path / "figure_18"))
    crosses = [line for ax in figures["figure_18"].axes for line in ax.lines if line.get_marker() == "x"]
    assert [len(line.get_xdata()) for line in crosses] == [13, 5]
    assert all("of the peak" in ax.get_title(loc="left") for ax in figures["figure_19"].axes)
