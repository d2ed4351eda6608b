"""One look: each model its own colour, families recognisable, unknown names refused."""

import pytest
from matplotlib.colors import to_rgb

from flexsurr.report.style import COLOURS, colour, dashes, family, label


def test_surrogates_have_colours_of_their_own():
    surrogates = ("mlp", "hnn", "polynomial", "dissipative_hnn", "port_hamiltonian", "rom", "fom")
    assert len({COLOURS[model] for model in surrogates}) == len(surrogates)


def test_a_model_of_another_sweep_is_pale_and_says_which():
    assert label("hnn_paper") == "HNN (paper)"
    assert label("dissipative_hnn") == "D-HNN"
    assert colour("hnn_paper") != colour("hnn")
    assert all(
        pale > full or full == 1.0
        for pale, full in zip(to_rgb(colour("hnn_paper")), to_rgb(colour("hnn")), strict=True)
    )


def test_a_network_of_ones_own_goes_by_its_class():
    name = "models/mine.py:MyField"
    assert label(name) == "MyField"
    assert colour(name) == colour(family(name)) not in {colour(model) for model in COLOURS}
    assert dashes(name) not in ("-", dashes("hnn"))


def test_a_model_nobody_knows_has_no_colour():
    with pytest.raises(KeyError, match="hnm"):
        colour("hnm")
