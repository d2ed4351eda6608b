"""The commit that a run names."""

import subprocess

import pytest

from flexsurr.cli.training import commit

AS_SOMEONE = ("-c", "user.name=Someone", "-c", "user.email=someone@example.org")


def git(*words):
    subprocess.run(["git", *AS_SOMEONE, *words], check=True, capture_output=True)


@pytest.fixture
def project(tmp_path, monkeypatch):
    """A checkout with one file, which is the current folder."""
    monkeypatch.chdir(tmp_path)
    git("init")
    (tmp_path / "model.py").write_text("a = 1\n")
    git("add", ".")
    git("commit", "--message", "model: first")
    return tmp_path


def test_a_checkout_that_differs_from_its_commit_says_so(project):
    found = commit()
    assert found is not None
    assert len(found) == 40
    (project / "results").mkdir()
    (project / "results/table.csv").write_text("1\n")
    assert commit() == found
    (project / "model.py").write_text("a = 2\n")
    assert commit() == f"{found}+"


def test_a_folder_without_a_commit_has_none(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("GIT_CEILING_DIRECTORIES", str(tmp_path.parent))
    assert commit() is None
