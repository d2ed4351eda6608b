"""Every name that the documents mention exists: functions, files, rules, targets, links, words of code."""

import importlib
import re
from pathlib import Path

import pytest

import flexsurr

TOP = Path(__file__).parents[2]
DOCUMENTS = [*sorted(TOP.glob("*.md")), *sorted((TOP / "docs").glob("*.md"))]
CAPTIONS = sorted((TOP / "workflow" / "report").glob("*.rst"))
PACKAGES = {path.name for path in (TOP / "flexsurr").iterdir() if (path / "__init__.py").exists()}
ENDINGS = {
    ".py",
    ".md",
    ".yaml",
    ".smk",
    ".csv",
    ".json",
    ".parquet",
    ".npz",
    ".txt",
    ".cff",
    ".toml",
    ".html",
}
NAME = re.compile(r"[A-Za-z_]\w*")
DOTTED = re.compile(r"[A-Za-z_]\w*(\.[A-Za-z_]\w*)+")


def sources() -> dict[Path, str]:
    """The text of everything that can define a name."""
    of_code = [
        path
        for folder in ("flexsurr", "workflow", "config", "profiles", "benchmarks")
        for path in (TOP / folder).rglob("*")
    ]
    files = [*of_code, TOP / "Makefile", TOP / "Snakefile", TOP / "pyproject.toml"]
    return {
        path: path.read_text()
        for path in files
        if path.suffix in {".py", ".smk", ".yaml", ".toml", ""} and path.is_file()
    }


SOURCES = sources()
WORDS = {word for text in SOURCES.values() for word in re.findall(r"\w+", text)}
FILE_NAMES = {path.name for path in TOP.rglob("*") if not {".venv", ".git", ".snakemake"} & set(path.parts)}
RULES = {name for text in SOURCES.values() for name in re.findall(r"^ *rule (\w+):", text, re.MULTILINE)}
# those that are made in a loop go by what their names begin with
RULES |= {
    name for text in SOURCES.values() for name in re.findall(r'^ *f"(\w+)_\{study\}', text, re.MULTILINE)
}
TARGETS = set(re.findall(r"^([\w-]+):", SOURCES[TOP / "Makefile"], re.MULTILINE))


def resolves(dotted: str) -> bool:
    """Whether a name below `flexsurr` can be imported, or is an attribute of what can be."""
    parts = dotted.split(".")
    for length in range(len(parts), 0, -1):
        try:
            found = importlib.import_module(".".join(parts[:length]))
        except ModuleNotFoundError:
            continue
        for part in parts[length:]:
            fields = {**getattr(found, "__annotations__", {}), **getattr(found, "model_fields", {})}
            if not hasattr(found, part) and part not in fields:
                return False
            found = getattr(found, part, None)
        return True
    return False


def is_key(dotted: str) -> bool:
    """Whether the parts are keys of some configuration file, each below the one before."""
    pattern = r"^ *" + r":.*?^ +".join(map(re.escape, dotted.split("."))) + ":"
    files = (text for path, text in SOURCES.items() if path.suffix == ".yaml")
    return any(re.search(pattern, text, re.MULTILINE | re.DOTALL) for text in files)


def unknown(text: str) -> str | None:
    """What is wrong with a piece of code in a document; None if nothing is, or if it is not a name."""
    text = text.strip()
    if re.search(r"[<>*…{}]", text) or text.startswith(("results/", "results-", "http")):
        return None
    name = re.sub(r"\(.*", "", text)
    if text.startswith("make "):
        target = text.split()[1]
        return None if target in TARGETS else f"no target {target} in the Makefile"
    paths = [word.strip("[],:") for word in text.split() if "/" in word and not word.startswith("results")]
    for path in paths:
        if Path(path).suffix in ENDINGS and not (TOP / path).exists():
            return f"no file {path}"
    if " " in name or not name:
        return None
    if Path(name).suffix in ENDINGS and "/" not in name:
        stem = Path(name).stem
        known = name in FILE_NAMES or name in " ".join(SOURCES.values()) or stem.replace("-", "_") in WORDS
        return None if known else f"no file {name}"
    if "/" in name and re.fullmatch(r"[\w./-]+", name):
        return None if (TOP / name).exists() else f"no file {name}"
    if DOTTED.fullmatch(name):
        path = name if name.startswith("flexsurr.") else f"flexsurr.{name}"
        if name.split(".")[0] in {"flexsurr", *PACKAGES} and resolves(path):
            return None
        if is_key(name):
            return None
        return f"no name {name}"
    if NAME.fullmatch(name) and len(name) > 2:
        return None if name in WORDS else f"no word {name} in the code"
    return None


def wrong_names(text: str, folder: Path) -> list[str]:
    """What a document mentions and is not there."""
    links = re.findall(r"\]\(([^)#\s]+)(?:#[^)]*)?\)", text)
    found = [f"no file {to}" for to in links if not to.startswith("http") and not (folder / to).exists()]
    for named in re.findall(r"\brules? ((?:`\w+`(?:, | and )?)+)", text):
        found += [
            f"no rule {name}" for name in re.findall(r"\w+", named.replace(" and ", " ")) if name not in RULES
        ]
    found += [
        f"no target {name}"
        for name in re.findall(r"^ {4}make (\w+)", text, re.MULTILINE)
        if name not in TARGETS
    ]
    for option in re.findall(r"--configfile (config/[\w/.-]+)", text):
        if not (TOP / option).exists():
            found.append(f"no file {option}")
    for script in re.findall(r"python ((?:benchmarks|examples)/\S+\.py)", text):
        if not (TOP / script).exists():
            found.append(f"no file {script}")
    inline = re.sub(r"^( {4}|```).*$", "", text, flags=re.MULTILINE)
    found += filter(None, map(unknown, re.findall(r"``?([^`\n]+)``?", inline)))
    return found


@pytest.mark.parametrize("path", [*DOCUMENTS, *CAPTIONS], ids=lambda path: path.name)
def test_names_exist(path):
    assert not wrong_names(path.read_text(), path.parent)


@pytest.mark.parametrize("path", CAPTIONS, ids=lambda path: path.name)
def test_captions_point_to_documents_that_exist(path):
    assert all((TOP / name).exists() for name in re.findall(r"docs/\w+\.md", path.read_text()))


@pytest.mark.parametrize(
    "text",
    [
        "`beam.described.no_such`",
        "`flexsurr.no_such.module`",
        "`evaluation.no_such_key`",
        "`config/studies/no_such.yaml`",
        "`no_such.csv`",
        "`no_such_word`",
        "rule `no_such`",
        "rules `train` and `no_such`",
        "`make no_such`",
        "    make no_such",
        "[text](no_such.md)",
        "    snakemake --configfile config/no_such.yaml",
        "`python benchmarks/no_such.py`",
    ],
)
def test_a_wrong_name_is_found(text):
    assert wrong_names(text, TOP / "docs")


def test_packages_are_those_that_the_documents_can_name():
    assert Path(flexsurr.__file__).parent == TOP / "flexsurr"


LEDGER = (TOP / "docs" / "paper.md").read_text()
VERDICTS = ("reproduced", "differs", "cannot be decided")


def ledger() -> list[list[str]]:
    """The rows of the ledger: id, place, statement, verdict, where, why."""
    rows = [line for line in LEDGER.splitlines() if re.match(r"\| \d+ \|", line)]
    return [[cell.strip() for cell in row.strip("|").split(" | ")] for row in rows]


def test_ledger_rows_are_whole_and_numbered():
    rows = ledger()
    assert [row[0] for row in rows] == [str(k + 1) for k in range(len(rows))]
    assert all(len(row) == 6 and all(row) for row in rows)
    assert {row[3] for row in rows} == set(VERDICTS)


def test_ledger_says_how_many_rows_have_which_verdict():
    counts = [sum(row[3] == verdict for row in ledger()) for verdict in VERDICTS]
    said = re.search(r"(\d+) statements: (\d+) reproduced, (\d+) differ, (\d+) cannot be decided", LEDGER)
    assert said is not None
    assert [int(number) for number in said.groups()] == [sum(counts), *counts]
