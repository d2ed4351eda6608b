"""A table as a page: readable as it is and, in a browser that runs scripts, sorted and searched.

pandas writes the table, DataTables (datatables.net) turns it into one that sorts. The page holds DataTables,
as itables packs it, compressed: nothing is fetched when the page is opened.
"""

import base64
import gzip
import html
import json
from functools import cache
from importlib.resources import files
from pathlib import Path

import pandas as pd

from flexsurr.storage import replacing

ROWS = 100
"""Tables with more rows are shown in pieces of as many."""

FEW = 12
"""Tables with no more are overlooked without a search."""

LONG = 40
"""Characters from which words are broken into lines."""


def save_page(frame: pd.DataFrame, title: str, caption: str, path: Path) -> None:
    """Write the `page` of `frame`, there whole or not at all."""
    with replacing(path) as beside:
        beside.write_text(page(frame, title, caption), encoding="utf-8")


def page(frame: pd.DataFrame, title: str, caption: str, figure: Path | None = None, notes: str = "") -> str:
    """A self-contained page: title, caption, an SVG if there is one, the table, and notes to it.

    Numbers have four digits, what is unknown is empty. Blank lines divide the texts into paragraphs.
    """
    return _PAGE.format(
        title=html.escape(title),
        caption=_paragraphs(caption),
        notes=_paragraphs(notes),
        figure="" if figure is None else _picture(figure, title),
        widths="\n".join(_widths(frame)),
        table=_table(frame),
        options=json.dumps(_options(len(frame))),
        script=_packed("dt_bundle.js"),
        style=_packed("dt_bundle.css"),
    )


def _paragraphs(text: str) -> str:
    return "\n".join(f"<p>{html.escape(part)}</p>" for part in text.strip().split("\n\n") if part)


def number(value: float) -> str:
    """A number as pages show it: whole ones whole, others in four digits; empty where unknown."""
    if pd.isna(value):
        return ""
    if float(value).is_integer() and abs(value) < 1e7:
        return f"{value:.0f}"
    return f"{value:.4g}".replace("e-0", "e-").replace("e+0", "e").replace("e+", "e")


def _table(frame: pd.DataFrame) -> str:
    shown = frame.astype(object).where(frame.notna(), "")
    for name in frame.select_dtypes("number"):
        shown[name] = frame[name].map(number)
    written = shown.to_html(index=False, border=0, justify="left")
    for name in map(html.escape, frame.columns):
        # a long name may be broken after an underscore
        written = written.replace(f"<th>{name}</th>", f"<th>{name.replace('_', '_<wbr>')}</th>", 1)
    return written


def _widths(frame: pd.DataFrame) -> list[str]:
    """A rule of CSS for each column of long words."""
    longest = [frame[name].map(lambda value: len(str(value))).max() for name in frame.columns]
    return [
        f"td:nth-child({place}) {{ white-space: normal; min-width: 24em; }}"
        for place, length in enumerate(longest, start=1)
        if length > LONG
    ]


def _options(rows: int) -> dict[str, object]:
    """Of DataTables: the order as it is written, pieces of long tables, a field to search in them."""
    is_long = rows > ROWS
    layout = {
        "topStart": "search" if rows > FEW else None,
        "topEnd": None,
        "bottomStart": "info" if is_long else None,
        "bottomEnd": "paging" if is_long else None,
    }
    return {"order": [], "paging": is_long, "pageLength": ROWS, "layout": layout}


def _picture(figure: Path, title: str) -> str:
    data = base64.b64encode(figure.read_bytes()).decode("ascii")
    return f'<img alt="{html.escape(title)}" src="data:image/svg+xml;base64,{data}">'


@cache
def _packed(name: str) -> str:
    """A file of itables, compressed, as text."""
    content = files("itables").joinpath("html", name).read_bytes()
    return base64.b64encode(gzip.compress(content, mtime=0)).decode("ascii")


_PAGE = """<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<title>{title}</title>
<style>
body {{ font: 14px/1.45 system-ui, sans-serif; margin: 2em; color: #1b1b1b; }}
p {{ max-width: 60em; }}
img {{ max-width: 100%; width: 62em; }}
table {{ border-collapse: collapse; font-size: 12.5px; }}
th {{ position: sticky; top: 0; background: #fff; border-bottom: 1.5px solid #000; text-align: left;
  vertical-align: bottom; padding: 4px 10px; max-width: 9em; }}
td {{ padding: 2px 10px; border-bottom: 1px solid #e4e4e4; white-space: nowrap; vertical-align: top; }}
td.dt-type-numeric {{ font-variant-numeric: tabular-nums; }}
tr:hover td {{ background: #f3f6fa; }}
{widths}
</style>
</head>
<body>
<h1>{title}</h1>
{caption}
{figure}
{table}
{notes}
<script type="module">
async function unpacked(text) {{
  const bytes = Uint8Array.from(atob(text), (character) => character.charCodeAt(0));
  const plain = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
  return new Response(plain).text();
}}
const style = document.createElement("style");
style.textContent = await unpacked("{style}");
document.head.prepend(style);
const script = new Blob([await unpacked("{script}")], {{ type: "text/javascript" }});
const {{ jQuery }} = await import(URL.createObjectURL(script));
jQuery("table").addClass("compact").DataTable({options});
</script>
</body>
</html>
"""
