"""The table of faults is true: each names a test that exists, and each test of this folder stands in it."""

import re
from pathlib import Path

TESTS = Path(__file__).resolve().parents[1]
NAMED = re.findall(r"\| (\S+\.py)::(\w+) \|$", (TESTS / "faults/faults.md").read_text(), re.MULTILINE)


def functions_of(file: Path) -> set[str]:
    return set(re.findall(r"^def (test_\w+)", file.read_text(), re.MULTILINE))


def test_each_fault_has_a_test():
    assert len(set(NAMED)) >= 40
    assert [(file, test) for file, test in NAMED if test not in functions_of(TESTS / file)] == []


def test_each_test_of_faults_is_in_the_table():
    here = {
        (f"faults/{file.name}", test)
        for file in (TESTS / "faults").glob("test_*.py")
        for test in functions_of(file)
    }
    assert {name for name in here if name[0] != "faults/test_table.py"} - set(NAMED) == set()
