"""The page of a table is all in one file, readable as it is; tests/workflow look at it in a browser."""

import re
from html.parser import HTMLParser

import pandas as pd
import pytest

from flexsurr.report.pages import FEW, ROWS, number, page

FRAME = pd.DataFrame(
    {
        "a_number": [1e-9, 2.0, None, 30.123456],
        "words<x": ["x<y & z", None, "w", "of more than forty characters, which may be broken"],
        "count": [1, 10, 2, 123456],
    }
)


class Cells(HTMLParser):
    """The texts of the cells of a page's table, and everything that the page would fetch."""

    def __init__(self, text):
        super().__init__()
        self.cells, self.fetched, self._in_cell = [], [], False
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        if tag in ("td", "th"):
            self._in_cell = True
            self.cells.append("")
        sources = [value for name, value in attrs if name in ("src", "href")]
        self.fetched += [source for source in sources if not source.startswith("data:")]

    def handle_endtag(self, tag):
        self._in_cell = self._in_cell and tag not in ("td", "th")

    def handle_data(self, data):
        if self._in_cell:
            self.cells[-1] += data


def test_all_of_a_table_can_be_read_without_its_script():
    found = Cells(page(FRAME, "Title", "Caption")).cells
    assert found[:3] == list(FRAME.columns)
    assert found[3:9] == ["1e-9", "x<y & z", "1", "2", "", "10"]
    assert found[9:] == ["", "w", "2", "30.12", FRAME["words<x"][3], "123456"]


def test_title_and_caption_are_text_and_paragraphs():
    text = page(FRAME, "A < B", "First & so.\n\nSecond.")
    assert "<h1>A &lt; B</h1>" in text
    assert "<p>First &amp; so.</p>\n<p>Second.</p>" in text


def test_nothing_is_fetched(tmp_path):
    figure = tmp_path / "figure.svg"
    figure.write_text("<svg/>")
    text = page(FRAME, "Title", "Caption", figure)
    assert Cells(text).fetched == []
    assert 'src="data:image/svg+xml;base64,PHN2Zy8+"' in text
    assert not re.search(r"https?://", text)


def test_the_same_table_is_the_same_page():
    assert page(FRAME, "Title", "Caption") == page(FRAME.copy(), "Title", "Caption")


@pytest.mark.parametrize(
    ("rows", "is_searched", "is_paged"), [(FEW, False, False), (ROWS, True, False), (ROWS + 1, True, True)]
)
def test_long_tables_are_searched_and_longer_ones_come_in_pieces(rows, is_searched, is_paged):
    text = page(pd.DataFrame({"n": range(rows)}), "Title", "")
    assert ('"topStart": "search"' in text) == is_searched
    assert ('"paging": true' in text) == is_paged


@pytest.mark.parametrize(
    ("value", "shown"),
    [
        (1.0, "1"),
        (15632, "15632"),
        (1.23456e-5, "1.235e-5"),
        (2.5e11, "2.5e11"),
        (float("nan"), ""),
        (0, "0"),
    ],
)
def test_numbers_have_four_digits_and_whole_ones_all(value, shown):
    assert number(value) == shown
