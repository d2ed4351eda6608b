"""The commit of the project that a run belongs to."""

import subprocess

PATIENCE_S = 5.0


def commit() -> str | None:
    """The hash of the commit that the current folder has checked out; None where there is none, or no git."""
    try:
        asked = subprocess.run(
            ["git", "rev-parse", "--verify", "HEAD"], capture_output=True, text=True, timeout=PATIENCE_S
        )
    except (OSError, subprocess.SubprocessError):
        return None
    return asked.stdout.strip() if asked.returncode == 0 else None
