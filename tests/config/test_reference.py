"""docs/reference.md is what `flexsurr reference` makes of the records, and leaves nothing out."""

import re
from pathlib import Path

import pytest

from flexsurr.config import reference
from flexsurr.config.reference import PAGES, descriptions, with_nested
from flexsurr.config.schema import Record
from flexsurr.config.trial import FIELDS, MAPS, OPTIMISERS

DOCUMENT = Path(__file__).parents[2] / "docs" / "reference.md"
RECORDS = sorted(
    {each for page in PAGES for record in page.records for each in with_nested(record)},
    key=lambda record: record.__name__,
)
SYMBOLS = {"m", "s", "kg", "N", "rad", "deg"}
UNIT = re.compile(r"([a-zA-Z°]+?)([²2]?)(?=[ /\]]|$)")


def unit_of_name(key):
    """The unit at the end of a key as a sorted list of factors: `bending_stiffness_N_m2` is in N and m2."""
    factors = []
    for word in reversed(key.split("_")):
        if word.rstrip("2") not in SYMBOLS:
            break
        factors.append(word)
    return sorted(factors)


def units_of_text(text):
    """The units in brackets, as above; where a factor stands, above or below, is for the reader."""
    found = re.findall(r"\[([^\]\d]*?(?:²[^\]\d]*?)*)\]", text)
    plain = [unit.replace("°", "deg").replace("²", "2") for unit in found]
    return [sorted(re.findall(r"[a-zA-Z]+2?", unit)) for unit in plain]


def test_the_document_is_up_to_date():
    assert DOCUMENT.read_text() == reference.reference(), "make reference"


@pytest.mark.parametrize("record", RECORDS, ids=lambda record: record.__name__)
def test_every_field_is_described(record):
    assert [key for key, meaning in descriptions(record).items() if not meaning] == []


@pytest.mark.parametrize("record", RECORDS, ids=lambda record: record.__name__)
def test_a_unit_in_a_name_stands_in_the_meaning(record):
    for key, meaning in descriptions(record).items():
        if unit := unit_of_name(key):
            assert unit in units_of_text(meaning), f"{key}: {meaning}"


def test_every_record_of_a_configuration_is_there():
    """Whatever record a module of the configuration defines, but for what only joins others."""

    def below(record):
        return [each for child in record.__subclasses__() for each in (child, *below(child))]

    written = {each for each in below(Record) if each.__module__.startswith("flexsurr.config.")}
    bases = {base for each in (*RECORDS, *FIELDS, *MAPS, *OPTIMISERS) for base in each.__mro__}
    of_sweeps = {"FieldSpace", "MapSpace", "FieldSweep", "MapSweep", "Range", "WholeRange", "WidthRange"}
    made = {each for each in written if each.__name__ in of_sweeps}
    joined = {each for each in written if each.__name__ == "Trial" or "By" in each.__name__}
    assert written - bases - made - joined == set()


def test_titles_are_different():
    titles = re.findall(r"^### (.*)$", DOCUMENT.read_text(), re.MULTILINE)
    assert len(set(titles)) == len(titles) == len(RECORDS)


def test_links_lead_to_a_title():
    text = DOCUMENT.read_text()
    titles = {title.lower().replace(" ", "-") for title in re.findall(r"^### (.*)$", text, re.MULTILINE)}
    assert set(re.findall(r"\]\(#([^)]*)\)", text)) <= titles


def test_a_field_without_a_description_is_an_error(monkeypatch):
    class Silent(Record):
        """A record."""

        length_m: float

    monkeypatch.setattr(reference, "PAGES", (reference.Page("silent.yaml", "", (Silent,)),))
    with pytest.raises(LookupError, match="length_m has no docstring"):
        reference.reference()


@pytest.mark.parametrize(("value", "written"), [(1e-7, "1.0e-7"), (2.5e300, "2.5e+300"), (0.001, "0.001")])
def test_numbers_are_written_so_that_yaml_reads_numbers(value, written):
    class One(Record):
        """A record."""

        x: float = value
        """A number."""

    assert reference._default(One.model_fields["x"]) == f"`{written}`"
