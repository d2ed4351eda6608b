"""The pictures of the documents: each is there, is looked at, and is made by `make pictures`."""

import re
from pathlib import Path

import pictures

TOP = Path(__file__).parents[2]
DOCUMENTS = [*TOP.glob("*.md"), *(TOP / "docs").glob("*.md")]
IMAGES = TOP / "docs" / "images"
LARGEST_BYTES = 300_000


def shown() -> set[Path]:
    """The pictures that documents show."""
    return {
        (document.parent / place).resolve()
        for document in DOCUMENTS
        for place in re.findall(r"!\[[^]]+\]\(([^)\s]+)\)", document.read_text())
    }


def test_every_picture_that_a_document_shows_is_made_by_the_command():
    assert shown() == {IMAGES / name for name in pictures.NAMES}


def test_every_picture_is_there_and_small():
    assert {path.name for path in IMAGES.iterdir()} == pictures.NAMES
    for path in IMAGES.iterdir():
        assert 1_000 < path.stat().st_size <= LARGEST_BYTES, path.name
