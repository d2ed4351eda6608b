from pathlib import Path

import pytest

from flexsurr.workflow.code_digest import code_digest, modules

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
}


@pytest.fixture
def root(tmp_path: Path) -> Path:
    for name, text in SOURCES.items():
        path = tmp_path / "flexsurr" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    return tmp_path


def test_a_name_leads_to_the_module_that_defines_it(root):
    assert modules("flexsurr.cli.simulate", root) == {
        "flexsurr",
        "flexsurr.cli.simulate",
        "flexsurr.beam.kernel",
        "flexsurr.simulation",
        "flexsurr.simulation.rhs",
    }


def test_imports_inside_functions_and_relative_ones_count(root):
    assert modules("flexsurr.cli.draw", root) == {
        "flexsurr",
        "flexsurr.cli.draw",
        "flexsurr.report",
        "flexsurr.beam.modes",
        "flexsurr.beam.shapes",
    }


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


def test_a_missing_module_is_named(root):
    with pytest.raises(ModuleNotFoundError, match=r"flexsurr\.cli\.absent"):
        code_digest("flexsurr.cli.absent", root)


@pytest.mark.parametrize(
    ("command", "needs", "does_without"),
    [
        ("simulate", "flexsurr.beam.compiled", "flexsurr.training"),
        ("manifest", "flexsurr.storage.manifest", "flexsurr.beam"),
        ("train", "flexsurr.training.fitting", "flexsurr.evaluation"),
        ("score", "flexsurr.evaluation.selection", "flexsurr.report"),
        ("select", "flexsurr.training.selection", "flexsurr.beam"),
        ("train_map", "flexsurr.training.map_fitting", "flexsurr.beam"),
        ("score_map", "flexsurr.cli.runs", "flexsurr.beam"),
        ("draw", "flexsurr.report.style", "flexsurr.training"),
        ("train", "flexsurr.cli.training_run", "flexsurr.tracking"),
    ],
)
def test_the_commands_depend_on_what_they_use(command, needs, does_without):
    found = modules(f"flexsurr.cli.{command}")
    assert needs in found
    assert not any(name.startswith(does_without) for name in found)
