"""The documentation as pages: it builds without a warning, and fetches nothing when it is looked at."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

TOP = Path(__file__).parents[2]
DOCUMENTS = sorted(path.stem for path in (TOP / "docs").glob("*.md"))
ADDRESS = re.compile(r"""(?:src|href|url)\s*[=(]\s*["']?((?:https?:)?//[^"')\s>]+)""")


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    """What `make docs` makes, in another folder."""
    folder = tmp_path_factory.mktemp("site")
    (line,) = re.findall(
        r"^\tpython (-m sphinx .*) build/site$", (TOP / "Makefile").read_text(), re.MULTILINE
    )
    done = subprocess.run(
        [sys.executable, *line.split(), folder / "pages", "--doctree-dir", folder / "doctrees"],
        cwd=TOP,
        capture_output=True,
        text=True,
        timeout=600,
    )
    assert done.returncode == 0, done.stderr
    return folder / "pages"


@pytest.mark.parametrize("document", DOCUMENTS)
def test_every_document_is_a_page_that_the_first_leads_to(site, document):
    assert (site / f"{document}.html").is_file()
    assert f'href="{document}.html"' in (site / "index.html").read_text() or document == "index"


def test_the_public_names_of_a_package_are_in_the_reference(site):
    page = (site / "api.html").read_text()
    assert 'id="flexsurr.beam.natural_modes"' in page
    assert "<p>Frequencies ω (n,) [rad/s], ascending" in page


def test_the_pages_fetch_nothing(site):
    """What a page loads is its own; what a person may click on is another matter."""
    loads = re.compile(r"<(?:script|link|img|iframe|source)\b[^>]*>")
    for page in site.rglob("*.html"):
        for tag in loads.findall(page.read_text()):
            if 'rel="canonical"' not in tag:
                assert not ADDRESS.search(tag), f"{page.name}: {tag}"
    for style in site.rglob("*.css"):
        assert not re.search(r"@import|url\(\s*[\"']?(?:https?:)?//", style.read_text()), style.name


def test_links_to_files_beside_the_documents_are_their_names(site):
    assert "../examples" not in (site / "own-structure.html").read_text()
    assert "examples/tip_load_release.py" in (site / "own-structure.html").read_text()
