"""A surrogate from Python: what its file holds, what it simulates, and where it warns."""

import warnings
from typing import get_args

import numpy as np
import pytest

import flexsurr
from flexsurr.beam import loaded, reduce, reduced_order
from flexsurr.config.history import Sine
from flexsurr.config.load import TipForce
from flexsurr.config.structure import Structure
from flexsurr.config.study import InitialConditions, Reduction
from flexsurr.library import ANY_STIFFNESS, Kept, OutOfRange
from flexsurr.simulation import simulate
from flexsurr.surrogates import SurrogateFileError, save
from flexsurr.training.configuration_samples import configuration_samples
from flexsurr.training.inverse_dynamics import fit_port_hamiltonian
from flexsurr.training.saved_surrogate import SavedSurrogate, save_surrogate

BEAM = Structure(
    name="strip",
    length_m=1.0,
    elements=4,
    joints=("out_of_plane",),
    mass_per_length_kg_m=0.2,
    bending_stiffness_out_of_plane_N_m2=50.0,
    damping_out_of_plane_s=1e-3,
)
LOAD = TipForce(force_N=3.0, history=Sine(frequency_rad_s=20.0))


def saved(structure=BEAM, modes=2):
    """A surrogate as good as the model it stands for."""
    basis = reduce(structure, Reduction(modes=modes, normalisation="mass"))
    samples = configuration_samples(basis, "hamiltonian", InitialConditions(), 200)
    return SavedSurrogate(
        surrogate=fit_port_hamiltonian(samples, 6),
        study="strips",
        variant="hamiltonian",
        run_id="port_hamiltonian-0123456789",
        low=samples.x_train.min(axis=0),
        high=samples.x_train.max(axis=0),
        basis=basis,
    )


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    path = tmp_path_factory.mktemp("run") / "weights.npz"
    save_surrogate(saved(), path)
    return path


@pytest.fixture(scope="module")
def strip(path):
    return flexsurr.load_surrogate(path)


def test_the_file_holds_what_it_stands_for(path, strip):
    expected, found = saved(), strip.saved
    assert found.basis.structure == BEAM
    for name in ("modes", "equilibrium", "stiffness", "damping", "omega_rad_s", "unit_norms"):
        np.testing.assert_array_equal(getattr(found.basis, name), getattr(expected.basis, name))
    for name in ("study", "variant", "run_id"):
        assert getattr(found, name) == getattr(expected, name)
    np.testing.assert_array_equal([found.low, found.high], [expected.low, expected.high])


@pytest.mark.parametrize("load", [None, LOAD, LOAD.model_dump()])
def test_it_responds_as_the_model_it_stands_for(strip, load):
    eta = 0.5 * strip.saved.high[0]
    found = strip.simulate(initial={"eta_1": eta}, duration_s=0.5, load=load)
    basis = strip.saved.basis
    exact = reduced_order(basis, "hamiltonian", "numpy")
    field = exact if load is None else loaded(exact, basis, LOAD, "numpy")
    x = simulate(field, found.t, np.array([eta, 0.0, 0.0, 0.0]), ANY_STIFFNESS).x
    size = np.abs(exact.tip(x)[:, 2]).max()
    np.testing.assert_allclose(found.tip, exact.tip(x), atol=1e-4 * size)
    np.testing.assert_allclose(found.twist, exact.twist(x), atol=1e-12)
    np.testing.assert_allclose(found.energy, exact.energy(x), atol=1e-3 * exact.energy(x).max())


def test_it_begins_at_rest_by_default(strip):
    hanging = saved(BEAM.model_copy(update={"gravity_m_s2": 9.81}))
    for each in (strip.saved, hanging):
        response = flexsurr.library.LoadedSurrogate(each).simulate(duration_s=0.2)
        away = np.abs(response.x - response.x[0]).max()
        assert away <= 0.02 * np.abs(each.high).max()
    assert response.x[0, 0] != 0.0


def test_outside_its_range_it_warns_once_and_says_where(strip):
    wild = 3.0 * strip.saved.high[0]
    with pytest.warns(OutOfRange) as caught:
        strip.simulate(initial={"eta_1": wild}, duration_s=0.5)
    (warning,) = caught
    assert warning.filename == __file__
    message = str(warning.message)
    for part in ("eta_1 reaches", "kg½ m", "trained from", strip.saved.run_id, f"{strip.saved.high[0]:.3g}"):
        assert part in message


def test_within_its_range_it_does_not_warn(strip):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        strip.simulate(initial={"eta_1": strip.saved.high[0]}, duration_s=0.5)


def test_which_state_leaves_the_range_first_is_named(strip):
    inside = 0.5 * (strip.saved.low + strip.saved.high)
    x = np.tile(inside, (5, 1))
    assert strip.saved.outside(x) == ""
    x[3, 0] = 2.0 * strip.saved.high[0]
    x[2, 1] = 2.0 * strip.saved.low[1]
    assert strip.saved.outside(x).startswith("eta_2 reaches ")


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"initial": {"eta_9": 1.0}}, "initial: 'eta_9' is no state; allowed: eta_1, eta_2, p_1, p_2"),
        ({"initial": [1.0]}, "initial: 4 numbers are needed"),
        ({"duration_s": 0.0}, "duration_s"),
        ({"load": {"kind": "tip_force", "force_N": 1.0, "direction": (0.0, 1.0, 0.0)}}, "no joint feels it"),
        ({"load": {"kind": "tip_force", "force_kN": 1.0}}, "force_kN"),
    ],
)
def test_what_it_cannot_do_is_said(strip, values, message):
    with pytest.raises(ValueError, match=message):
        strip.simulate(**{"duration_s": 0.1, **values})


STARTS = np.random.default_rng(0).uniform(0.2, 0.8, (5, 4)) * [1.0, 1.0, 0.0, 0.0]


def test_an_ensemble_is_what_its_responses_are(strip, monkeypatch):
    # a method that nothing has to be compiled for; the next test but one takes the compiled one
    monkeypatch.setattr("flexsurr.library.REFERENCE", ANY_STIFFNESS)
    x0 = STARTS * strip.saved.high
    settings = {"duration_s": 0.2, "load": LOAD, "integrator": ANY_STIFFNESS}
    each = [strip.simulate(initial=start, **settings) for start in x0]
    kept = {k: strip.simulate_ensemble(initial=x0, keep=k, **settings) for k in get_args(Kept)}
    np.testing.assert_array_equal(kept["states"].kept, [response.x for response in each])
    np.testing.assert_array_equal(kept["tip"].kept, [response.tip for response in each])
    # the final ones are asked for without samples between, where SciPy's method interpolates
    np.testing.assert_allclose(kept["final"].kept, [response.x[-1] for response in each], atol=1e-6)
    np.testing.assert_allclose(kept["final_tip"].kept, [response.tip[-1] for response in each], atol=1e-6)
    assert kept["tip_error"].kept.shape == (5,)
    assert np.all(kept["tip_error"].kept < 0.1)
    assert np.all(kept["tip_error"].kept > 0.0)


def test_each_response_of_an_ensemble_may_have_a_load(strip):
    x0 = STARTS[:2] * strip.saved.high
    settings = {"duration_s": 0.2, "integrator": ANY_STIFFNESS}
    found = strip.simulate_ensemble(initial=x0, load=[None, LOAD], **settings)
    for load, start, final in zip([None, LOAD], x0, found.kept, strict=True):
        one = strip.simulate(initial=start, step_s=0.2, load=load, **settings)
        np.testing.assert_array_equal(final, one.x[-1])


def test_an_ensemble_says_once_how_many_leave_the_range(strip):
    x0 = np.array([0.1, 3.0, 4.0])[:, None] * [1.0, 0.0, 0.0, 0.0] * strip.saved.high
    with pytest.warns(OutOfRange, match="2 of 3 responses, eta_1 reaches") as caught:
        strip.simulate_ensemble(initial=x0, duration_s=0.1)
    assert len(caught) == 1


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"keep": "nose"}, "keep: 'nose' is not allowed; allowed: final, states"),
        ({"initial": [0.0, 0.0, 0.0, 0.0]}, "initial: rows of 4 finite numbers"),
        ({"load": [None, None]}, "2 models do not fit 1 states"),
        ({"device": "cpu", "load": LOAD}, "torch knows no loads"),
    ],
)
def test_what_an_ensemble_cannot_be_is_said(strip, values, message):
    with pytest.raises(ValueError, match=message):
        strip.simulate_ensemble(**{"initial": np.zeros((1, 4)), "duration_s": 0.1, **values})


def test_what_it_prints_is_what_a_person_asks_first(strip):
    text = str(strip)
    for part in (
        "port_hamiltonian-0123456789",
        "strip: 1 m, 4 elements",
        "tip position [m]",
        "eta_2",
        "kg½ m",
    ):
        assert part in text


def test_a_response_is_a_table_and_a_figure(strip, tmp_path):
    response = strip.simulate(initial={"eta_1": 0.1}, duration_s=0.1)
    table = response.table()
    assert list(table) == [
        "t_s", "eta_1", "eta_2", "p_1", "p_2", "tip_x_m", "tip_y_m", "tip_z_m", "tip_twist_rad", "energy_J",
    ]  # fmt: skip
    np.testing.assert_array_equal(table["tip_z_m"], response.tip[:, 2])
    figure = response.plot(tmp_path / "response.png")
    assert (tmp_path / "response.png").read_bytes().startswith(b"\x89PNG")
    # a beam that bends out of plane has no y and no twist to show
    assert [ax.get_ylabel() for ax in figure.axes] == ["tip x [m]", "tip z [m]"]


def test_without_a_structure_there_are_states_alone(tmp_path):
    one = saved()
    bare = SavedSurrogate(one.surrogate, "data", "measured", one.run_id, one.low, one.high, None)
    save_surrogate(bare, tmp_path / "weights.npz")
    found = flexsurr.load_surrogate(tmp_path / "weights.npz")
    response = found.simulate(initial=[0.1, 0.0, 0.0, 0.0], duration_s=0.1)
    assert response.tip is None
    assert len(response.plot().axes) == 4
    with pytest.raises(ValueError, match="stands for no structure"):
        found.simulate(duration_s=0.1, load=LOAD)


def test_a_file_that_does_not_know_is_refused_with_its_name(tmp_path):
    save(saved().surrogate, tmp_path / "weights.npz")
    with pytest.raises(SurrogateFileError, match=r"weights\.npz: .*knows what it stands for"):
        flexsurr.load_surrogate(tmp_path / "weights.npz")
