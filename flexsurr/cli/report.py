"""Figures, tables and the answer, of what the evaluation has left."""

import html
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import pandas as pd

from flexsurr.cli.command import Job, for_rules
from flexsurr.cli.runs import read_run
from flexsurr.config.structure import Structure
from flexsurr.report.catalogue import OF_AIRCRAFT, TABLES
from flexsurr.report.pages import save_page
from flexsurr.report.tables import TABULATE, save_table
from flexsurr.storage import replacing
from flexsurr.storage.frames import read_frame, read_text_frame, write_frame


@for_rules(results="the folder of all results", folder="of the figures")
def draw(job: Job, results: Path, folder: Path) -> None:
    """Draw the figures of a study that show what one rule has made.

    Each is an SVG and a PNG.
    """
    from flexsurr.report.figures import DRAW
    from flexsurr.report.style import save

    known: dict[str, Any] = {}
    for name, figure in job.items():
        if "aircraft" in figure and not known:  # a study has one, and its modes take a second
            known = _of_aircraft(figure["aircraft"])
        save(DRAW[name](*_arguments(figure, results, known)), folder / name)


def _of_aircraft(flight: Job) -> dict[str, Any]:
    """What a figure may show of the aircraft of a job that flies it (`catalogue.OF_AIRCRAFT`)."""
    # here, for it takes a second that no figure of another study needs
    from flexsurr.cli.flight import airliner_of
    from flexsurr.evaluation.airliner_models import lattice_operations

    airliner = airliner_of(flight)
    return {
        "free_modes": airliner.modes,
        "lattice": airliner.airframe.lattice,
        "doublet": airliner.settings.doublet,
        "lattice_operations": lattice_operations(airliner, flight["boundary_condition"]),
    }


@for_rules(results="the folder of all results", captions="what to see in them", folder="of the tables")
def tabulate(job: Job, results: Path, captions: list[Path], folder: Path) -> None:
    """Write tables of a study, each as a CSV file and as a page.

    `captions` are named as the tables.
    """
    texts = {caption.stem: _text_of(caption) for caption in captions}
    for name, table in job.items():
        frame = TABULATE[name](*_arguments(table, results))
        save_table(frame, folder / f"{name}.csv")
        save_page(frame, TABLES[name].title, texts[name], folder / f"{name}.html")


def _arguments(job: Job, results: Path, known: Mapping[str, Any] | None = None) -> list[Any]:
    """What the job `reads`, in its order: its structure, what is `known`, or what its files hold."""
    known = known or {}
    return [
        known[read] if read in known else _read(read, job, [results / file for file in files])
        for read, files in job["reads"].items()
    ]


def _text_of(caption: Path) -> str:
    """What to see in a table, on one line."""
    return " ".join(caption.read_text(encoding="utf-8").split())


def _read(read: str, job: Job, files: Sequence[Path]) -> Any:
    if read == "structure":
        return Structure.model_validate(job["structure"])
    if read in ("sweeps", "selection"):
        return job[read]
    if read in OF_AIRCRAFT:
        return None
    if read in ("metrics", "relatives"):
        return pd.DataFrame([read_run(path) for path in files])
    if read == "history":
        frames = [read_frame(path).assign(run_id=path.parent.name) for path in files]
    else:
        frames = [read_frame(path) for path in files]
    return pd.concat([frame for frame in frames if len(frame)] or frames, ignore_index=True)


@for_rules(inputs="the tables of each study", folder="where all of them go")
def join(job: Job, inputs: list[Path], folder: Path) -> None:
    """Join the tables of all studies, one below another.

    Those of `inputs` that have one name become one table of that name, to the letter.
    """
    for name in dict.fromkeys(path.name for path in inputs):
        # As text: a number that is read and written again may come out with other digits.
        tables = [
            read_text_frame(path, dtype=str, keep_default_na=False) for path in inputs if path.name == name
        ]
        write_frame(folder / name, pd.concat(tables, ignore_index=True))


TITLE = "When does a surrogate pay?"


@for_rules(
    cost="cost.csv of all studies",
    caption="what to see in the answer",
    table="its table, as CSV",
    figure="its figure, as SVG",
    output="its page",
    frame="the page within a frame",
)
def answer(job: Job, cost: Path, caption: Path, table: Path, figure: Path, output: Path, frame: Path) -> None:
    """Answer the question of every study: when a surrogate pays, how much, and at what loss.

    A PNG stands beside the `figure`. `frame` holds the page once more, as a piece of HTML that shows it
    within another page: the report's.
    """
    from flexsurr.report.answer import answer as answer_of
    from flexsurr.report.answer import in_words
    from flexsurr.report.answer_figure import answer_figure
    from flexsurr.report.pages import page
    from flexsurr.report.style import save

    answered = answer_of(read_text_frame(cost))
    save_table(answered, table)
    save(answer_figure(answered), figure.with_suffix(""))
    whole = page(answered, TITLE, "\n\n".join(in_words(answered)), figure, _text_of(caption))
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
