import ast
from pathlib import Path

import pytest

from flexsurr.cli.index import function_of
from flexsurr.workflow.code_digest import PACKAGE, ROOT, _import_statements, code_digest, parts

SOURCES = {
    "__init__.py": '"""Docstring."""\n__version__ = "1"\n',
    "beam/__init__.py": 'from flexsurr.beam.kernel import f\nfrom .modes import g\n__all__ = ["f", "g"]\n',
    "beam/kernel.py": "from flexsurr.simulation import rhs\ndef f(): ...\n",
    "beam/modes.py": "from . import shapes\ndef g(): ...\n",
    "beam/shapes.py": "",
    "simulation/__init__.py": "from flexsurr.simulation.rhs import rhs\nprint('more than names')\n",
    "simulation/rhs.py": "def rhs(): ...\n",
    "report.py": "import flexsurr.beam.modes\n",
    "cli/__init__.py": "",
    "cli/simulate.py": "from flexsurr.beam import f\n",
    "cli/draw.py": "def main():\n    from flexsurr import report\n",
    "cli/files.py": "def read():\n    # how\n    ...\ndef write(): ...\n",
    "cli/two.py": """
from flexsurr.beam import f, g
from flexsurr.cli.files import read, write

LIMIT = 3.0

def declared(work):
    return work

@declared
def shown(limit=LIMIT):
    return _shape()

def _shape():
    return g

@declared
def moved():
    return f, read()
""",
}
SHOWN, MOVED = "flexsurr.cli.two:shown", "flexsurr.cli.two:moved"


@pytest.fixture
def root(tmp_path: Path) -> Path:
    for name, text in SOURCES.items():
        path = tmp_path / "flexsurr" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    return tmp_path


def test_a_name_leads_to_the_module_that_defines_it(root):
    assert parts("flexsurr.cli.simulate", root) == {
        "flexsurr",
        "flexsurr.cli.simulate",
        "flexsurr.beam.kernel",
        "flexsurr.simulation",
        "flexsurr.simulation.rhs",
    }


def test_imports_inside_functions_and_relative_ones_count(root):
    assert parts("flexsurr.cli.draw", root) == {
        "flexsurr",
        "flexsurr.cli.draw",
        "flexsurr.report",
        "flexsurr.beam.modes",
        "flexsurr.beam.shapes",
    }


def test_of_a_module_with_commands_what_one_of_them_uses_counts(root):
    of_all = {"flexsurr"}
    assert parts(SHOWN, root) == of_all | {SHOWN, "flexsurr.beam.modes", "flexsurr.beam.shapes"}
    of_beam = {"flexsurr.beam.kernel", "flexsurr.simulation", "flexsurr.simulation.rhs"}
    assert parts(MOVED, root) == of_all | of_beam | {MOVED, "flexsurr.cli.files:read"}


@pytest.mark.parametrize(
    ("file", "old", "new", "changed"),
    [
        ("two", "LIMIT = 3.0", "LIMIT = 4.0", {SHOWN}),
        ("two", "    return g", "    return g  # why", {SHOWN}),
        ("two", "return f, read()", "return read(), f", {MOVED}),
        ("two", "    return work", "    return work or None", {SHOWN, MOVED}),
        ("two", "\n@declared\ndef moved", "\n# why\n\n@declared\ndef moved", set()),
        ("two", "\n@declared\ndef moved", "\n@declared\n@declared\ndef moved", {MOVED}),
        ("two", "import f, g", "import g, f", set()),
        ("two", "LIMIT = 3.0", "LIMIT = 3.0\nprint(LIMIT)", {SHOWN, MOVED}),
        ("files", "# how", "# how so", {MOVED}),
        ("files", "def write(): ...", "def write(): return 1", set()),
    ],
)
def test_editing_a_command_changes_what_uses_the_edited(tmp_path_factory, file, old, new, changed):
    digests = []
    for replaced in (old, new):
        folder = tmp_path_factory.mktemp("sources")
        for name, text in SOURCES.items():
            path = folder / "flexsurr" / name
            path.parent.mkdir(parents=True, exist_ok=True)
            assert name != f"cli/{file}.py" or old in text
            path.write_text(text.replace(old, replaced) if name == f"cli/{file}.py" else text)
        digests.append({command: code_digest(command, folder) for command in (SHOWN, MOVED)})
    before, after = digests
    assert {command for command in before if before[command] != after[command]} == changed


@pytest.mark.parametrize(
    ("edited", "changed"),
    [
        ("beam/kernel.py", {"flexsurr.cli.simulate"}),
        ("beam/shapes.py", {"flexsurr.cli.draw"}),
        ("beam/__init__.py", set()),
        ("simulation/__init__.py", {"flexsurr.cli.simulate"}),
        ("__init__.py", {"flexsurr.cli.simulate", "flexsurr.cli.draw"}),
    ],
)
def test_editing_a_file_changes_the_digests_that_count_it(tmp_path_factory, edited, changed):
    """Two trees, since a digest is remembered for as long as its process lives."""
    digests = []
    for comment in ("", "# a comment\n"):
        folder = tmp_path_factory.mktemp("sources")
        for name, text in SOURCES.items():
            path = folder / "flexsurr" / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text + (comment if name == edited else ""))
        commands = ("flexsurr.cli.simulate", "flexsurr.cli.draw")
        digests.append({command: code_digest(command, folder) for command in commands})
    before, after = digests
    assert {command for command in before if before[command] != after[command]} == changed


def test_no_import_of_the_package_is_overlooked():
    """They are found without parsing the rest of a file; here all of it is parsed."""
    for path in (ROOT / PACKAGE).rglob("*.py"):
        module = ".".join(path.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__")
        whole = ast.walk(ast.parse(path.read_bytes()))
        imports = {ast.dump(node) for node in whole if isinstance(node, ast.Import | ast.ImportFrom)}
        assert imports <= {ast.dump(node) for node in _import_statements(ROOT, module)}, module


def test_a_missing_module_or_function_is_named(root):
    with pytest.raises(ModuleNotFoundError, match=r"flexsurr\.cli\.absent"):
        code_digest("flexsurr.cli.absent", root)
    with pytest.raises(AttributeError, match=r"flexsurr\.cli\.two: defines no absent"):
        code_digest("flexsurr.cli.two:absent", root)


@pytest.mark.parametrize(
    ("command", "needs", "does_without"),
    [
        ("simulate", "flexsurr.beam.compiled", "flexsurr.training"),
        ("manifest", "flexsurr.storage.manifest", "flexsurr.beam"),
        ("train", "flexsurr.training.fitting", "flexsurr.evaluation"),
        ("score", "flexsurr.evaluation.scores", "flexsurr.report"),
        ("select", "flexsurr.evaluation.selection", "flexsurr.beam"),
        ("trials", "flexsurr.training.fitting", "flexsurr.training.map_fitting"),
        ("shards", "flexsurr.beam.compiled", "flexsurr.storage.source_files"),
        ("train-map", "flexsurr.training.map_fitting", "flexsurr.beam"),
        ("score-map", "flexsurr.cli.runs:read_run", "flexsurr.beam"),
        ("draw", "flexsurr.report.style", "flexsurr.training"),
        ("train", "flexsurr.storage.files", "flexsurr.tracking"),
    ],
)
def test_the_commands_depend_on_what_they_use(command, needs, does_without):
    found = parts(function_of(command))
    assert needs in found
    assert not any(name.startswith(does_without) for name in found)
