"""Trouble with the page is a warning, never more."""

import logging
import re

LONGEST_REASON = 300

log = logging.getLogger(__name__)
logging.getLogger("urllib3").setLevel(logging.ERROR)  # a server that is away is our own warning


def warn(what: str, error: Exception) -> None:
    """Say on one line, without passwords, that results are made without `what`, and why."""
    reason = " ".join(f"{type(error).__name__}: {error}".split())[:LONGEST_REASON]
    without_secrets = shown(f"{what} ({reason})")
    log.warning("tracking: %s; results are made without it", without_secrets)


def shown(text: str) -> str:
    """`text` without the names and passwords of addresses in it."""
    return re.sub(r"://[^/@ ]*@", "://…@", text)
