"""How Sphinx makes pages of these documents and of the docstrings: `make docs`. Nothing is fetched."""

import re

from markdown_it import MarkdownIt

import flexsurr

project = "flexsurr"
author = "The flexsurr authors"
copyright = author
version = release = flexsurr.__version__

extensions = ["myst_parser", "sphinx.ext.autodoc"]
html_theme = "furo"
html_title = "flexsurr"
html_show_sourcelink = False
html_copy_source = False

myst_heading_anchors = 4  # as links have them: (measurements.md#what-falls-short)

autodoc_default_options = {"members": True, "imported-members": True, "member-order": "groupwise"}
autodoc_typehints = "none"  # shapes and units are in the docstrings, which say more


def as_markdown(app, what, name, obj, options, lines):
    """Docstrings are Markdown; Sphinx takes them for its own language."""
    html = MarkdownIt("commonmark").enable("table").render("\n".join(lines))
    if html:
        lines[:] = [".. raw:: html", "", *("   " + line for line in html.splitlines()), ""]


def without_files(app, docname, source):
    """Links to files beside the documents lead nowhere on a page: their names stay."""
    source[0] = re.sub(r"\[(`?[^]`]+`?)\]\(\.\./[^)]*\)", r"\1", source[0])


def every_document(app, docname, source):
    """A document that the first page does not name stands at its end, rather than nowhere."""
    if docname == "index":
        others = sorted(app.env.found_docs - {"index", *re.findall(r"^[\w-]+$", source[0], re.MULTILINE)})
        if others:
            source[0] += "\n```{toctree}\n:caption: More\n:maxdepth: 1\n\n" + "\n".join(others) + "\n```\n"


def setup(app):
    """Called by Sphinx."""
    app.connect("autodoc-process-docstring", as_markdown)
    app.connect("source-read", without_files)
    app.connect("source-read", every_document)
