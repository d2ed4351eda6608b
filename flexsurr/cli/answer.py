"""Answer the question of every study: when a surrogate pays, how much, and at what loss."""

import html
from pathlib import Path

from flexsurr.cli.command import Job, command
from flexsurr.cli.frames import read_text_frame
from flexsurr.cli.products import text_of
from flexsurr.report.answer import answer, in_words
from flexsurr.report.answer_figure import answer_figure
from flexsurr.report.pages import page
from flexsurr.report.style import save
from flexsurr.report.tables import save_table
from flexsurr.storage import replacing

TITLE = "When does a surrogate pay?"


def main(job: Job, cost: Path, caption: Path, table: Path, figure: Path, output: Path, frame: Path) -> None:
    """Write the answer that `cost` gives: `table` (CSV), `figure` (SVG, a PNG beside it), a page of both.

    `frame` holds the page once more, as a piece of HTML that shows it within another page: the report's.
    """
    answered = answer(read_text_frame(cost))
    save_table(answered, table)
    save(answer_figure(answered), figure.with_suffix(""))
    whole = page(answered, TITLE, "\n\n".join(in_words(answered)), figure, text_of(caption))
    for path, content in ((output, whole), (frame, _framed(whole))):
        with replacing(path) as beside:
            beside.write_text(content, encoding="utf-8")


def _framed(whole: str) -> str:
    """A page in a frame; wide where the report opens with it, away where that shows its graph of rules."""
    return f"""<style>
.prose:has(#answer) {{ max-width: none; }}
ul:has(#answer) > :not(.prose) {{ display: none; }}
#answer {{ width: calc(100vw - 18rem); height: calc(100vh - 8rem); border: 0; }}
:has(> div#rulegraph) #answer {{ display: none; }}
</style>
<iframe id="answer" title="{TITLE}" srcdoc="{html.escape(whole)}"></iframe>
"""


if __name__ == "__main__":
    command(
        main,
        {
            "cost": "cost.csv of all studies",
            "caption": "what to see in the answer",
            "table": "its table, as CSV",
            "figure": "its figure, as SVG",
            "output": "its page",
            "frame": "the page within a frame",
        },
    )
