"""The audit of pinned packages, on advisories made up here."""

import json
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

AUDIT = Path(__file__).parents[2] / ".ci" / "audit.py"


def advisory(events=(), versions=(), ecosystem="PyPI", name="Some.Package", **more):
    return {
        "id": "PYSEC-0",
        "summary": "it breaks",
        "affected": [
            {
                "package": {"ecosystem": ecosystem, "name": name},
                "ranges": [{"type": "ECOSYSTEM", "events": list(events)}],
                "versions": list(versions),
            }
        ],
        **more,
    }


def audited(folder, content, version, archive=True):
    """The audit's outcome for one advisory and one package."""
    if archive:
        path = folder / "advisories.zip"
        with zipfile.ZipFile(path, "w") as file:
            file.writestr("PYSEC-0.json", json.dumps(content))
    else:
        path = folder / "advisories"
        path.mkdir()
        (path / "PYSEC-0.json").write_text(json.dumps(content))
    (folder / "environment.txt").write_text(f"# pinned\nsome-package=={version}\nother==1.0\n")
    return run(folder, path)


def run(folder, advisories):
    return subprocess.run(
        [sys.executable, AUDIT, "--advisories", advisories, folder / "environment.txt"],
        capture_output=True,
        text=True,
    )


RANGE = ({"introduced": "0"}, {"fixed": "1.10"}, {"introduced": "2.0rc1"}, {"last_affected": "2.1"})


@pytest.mark.parametrize(
    ("version", "known"),
    [
        ("0.1", True),
        ("1.9", True),
        ("1.10", False),
        ("1.11", False),
        ("2.0", True),
        ("2.1", True),
        ("2.1.1", False),
    ],
)
def test_a_version_within_a_range_is_known(tmp_path, version, known):
    outcome = audited(tmp_path, advisory(RANGE), version)
    assert outcome.returncode == known
    assert (f"some-package {version}: PYSEC-0: it breaks\n" == outcome.stdout) is known


@pytest.mark.parametrize(
    ("content", "known"),
    [
        (advisory(versions=["1.0.0"]), True),
        (advisory(versions=["1.0.1", "not a version"]), False),
        (advisory(RANGE, withdrawn="2026-01-01T00:00:00Z"), False),
        (advisory(RANGE, ecosystem="npm"), False),
        (advisory(RANGE, name="another"), False),
    ],
)
def test_only_what_concerns_a_package_is_known(tmp_path, content, known):
    assert audited(tmp_path, content, "1.0", archive=False).returncode == known


def test_without_advisories_it_says_so(tmp_path):
    (tmp_path / "environment.txt").write_text("a==1\n")
    outcome = run(tmp_path, tmp_path / "no.zip")
    assert outcome.returncode == 1
    assert "no such file, so nothing was audited" in outcome.stderr
    assert "Traceback" not in outcome.stderr


def test_what_is_no_archive_is_named(tmp_path):
    (tmp_path / "environment.txt").write_text("a==1\n")
    (tmp_path / "all.zip").write_text("no")
    outcome = run(tmp_path, tmp_path / "all.zip")
    assert outcome.returncode == 1
    assert "no advisories in the OSV format" in outcome.stderr
    assert "Traceback" not in outcome.stderr
