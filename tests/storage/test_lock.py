"""One process at a time in a folder, and file systems on which that cannot be had."""

import errno
import fcntl
import logging
import subprocess
import sys

import pytest

from flexsurr.storage.files import NO_LOCKS, locked

SECOND = "import sys; from pathlib import Path; from flexsurr.storage.files import locked\n"
SECOND += "with locked(Path(sys.argv[1])): print('inside', flush=True)"


def test_a_second_process_waits_for_the_first(tmp_path):
    with locked(tmp_path):
        second = subprocess.Popen([sys.executable, "-c", SECOND, tmp_path], stdout=subprocess.PIPE, text=True)
        with pytest.raises(subprocess.TimeoutExpired):
            second.wait(3)
    assert second.communicate(timeout=60)[0] == "inside\n"


@pytest.mark.parametrize("number", sorted(NO_LOCKS))
def test_a_file_system_without_locks_is_one_warning(tmp_path, monkeypatch, caplog, number):
    def refuse(handle: int, operation: int) -> None:
        raise OSError(number, "no locks")

    monkeypatch.setattr(fcntl, "flock", refuse)
    with caplog.at_level(logging.WARNING), locked(tmp_path / "run"):
        pass
    assert [record.getMessage() for record in caplog.records] == [
        f"{tmp_path / 'run'}: no locks here (no locks); goes on without one"
    ]


def test_any_other_trouble_with_locks_passes(tmp_path, monkeypatch):
    def refuse(handle: int, operation: int) -> None:
        raise OSError(errno.EIO, "input/output error")

    monkeypatch.setattr(fcntl, "flock", refuse)
    with pytest.raises(OSError, match="input/output"), locked(tmp_path):
        pass
