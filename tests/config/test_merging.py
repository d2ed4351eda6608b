import re
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import BaseModel

from flexsurr.config.errors import ConfigurationError
from flexsurr.config.reading import Source, build, merge
from flexsurr.config.schema import part_of, values_of
from flexsurr.config.settings import load
from flexsurr.config.sources import ResolvedSampleStudy
from flexsurr.config.study import Reduction, Study

REPOSITORY = Path(__file__).resolve().parents[2]
VALUES = st.recursive(
    st.integers() | st.lists(st.integers(), max_size=2),
    lambda inner: st.dictionaries(st.sampled_from("abc"), inner, max_size=3),
    max_leaves=6,
)
MAPPINGS = st.dictionaries(st.sampled_from("abc"), VALUES, max_size=3)
STUDY = Study(structure="s.yaml", sweeps={"default": "w.yaml"}, reduction=Reduction(modes=1))


@given(a=MAPPINGS)
def test_nothing_and_itself_change_nothing(a):
    assert merge(a, {}) == merge({}, a) == merge(a, a) == a


@given(a=MAPPINGS, b=MAPPINGS)
def test_what_lies_on_top_stays(a, b):
    """Merging `b` once more changes nothing, and every plain value of `b` is there."""
    merged = merge(a, b)
    assert merge(merged, b) == merged
    assert all(merged[key] == value for key, value in b.items() if not isinstance(value, dict))


class Inner(BaseModel):
    number: int = 0


class Outer(BaseModel):
    inner: Inner = Inner()


def test_the_blame_goes_to_the_last_file_that_holds_the_value():
    sources = [
        Source("first", {"inner": {"number": "one"}}),
        Source("second", {"inner": {"number": "two"}}, ("below",)),
        Source("third", {"inner": {}}),
    ]
    with pytest.raises(
        ConfigurationError, match=re.escape("second: below.inner.number: 'two' is not allowed")
    ):
        build(Outer, sources)


@pytest.mark.parametrize("preset", [path.name for path in (REPOSITORY / "config/presets").glob("*.yaml")])
def test_every_preset_is_sound(preset):
    configuration = load(REPOSITORY, ["config/config.yaml", f"config/presets/{preset}"])
    structures = [s.structure.name for s in configuration.studies if not isinstance(s, ResolvedSampleStudy)]
    alone = {"smoke.yaml": "cantilever", "tapered_wing.yaml": "tapered_wing", "crossover.yaml": "hale_wing"}
    assert structures == ([alone[preset]] if preset in alone else ["cantilever", "wing"])


def test_a_study_has_its_own_values_and_otherwise_those_of_the_study_it_is_based_on(root):
    (root / "mine.yaml").write_text("studies: [wing, wing_unit]\n")
    base, study = (one.study for one in load(root, ["config/config.yaml", "mine.yaml"]).studies)
    assert (base.reduction.normalisation, study.reduction.normalisation) == ("mass", "unit")
    assert study.reduction.modes == base.reduction.modes
    assert (study.datasets, study.sweeps, study.trains_on) == (base.datasets, base.sweeps, base.trains_on)
    assert study.evaluation.integrators == base.evaluation.integrators
    assert (base.evaluation.simulations, study.evaluation.simulations) == (10, 2)


def test_a_part_has_the_values_it_was_made_of():
    keys = ("seed", "dataset.initial_conditions", "dataset.step_s", "evaluation.integrators", "reduction")
    part = part_of(Study, values_of(STUDY, keys))
    assert part.seed == STUDY.seed
    assert part.dataset.initial_conditions == STUDY.dataset.initial_conditions
    assert part.evaluation.integrators == STUDY.evaluation.integrators


def test_a_part_has_no_other_values():
    part = part_of(Study, values_of(STUDY, ("dataset.step_s",)))
    for read in (lambda: part.seed, lambda: part.dataset.trajectories, lambda: part.sweeps):
        with pytest.raises(AttributeError):
            read()
