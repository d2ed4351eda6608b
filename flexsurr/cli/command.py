"""What every command has in common: its arguments, its log, and how it ends."""

import argparse
import json
import logging
import signal
import sys
from collections.abc import Callable, Mapping
from pathlib import Path
from types import FrameType
from typing import Any

from flexsurr.config.errors import ConfigurationError
from flexsurr.storage import StorageError

Job = Mapping[str, Any]
EXPECTED: tuple[type[Exception], ...] = (StorageError, ConfigurationError)

INTERRUPTED = 130
TERMINATED = 143


def command(
    work: Callable[..., None],
    files: Mapping[str, str],
    expected: tuple[type[Exception], ...] = (),
) -> None:
    """Run `work(job, <file>, …)` as this process's command for the workflow, and end the process.

    `files` maps names of options to what they hold; where the text ends in "…" the option takes any number.
    Ends as `personal` does, and logs with the time of day.
    """
    logging.basicConfig(
        level=logging.INFO, stream=sys.stderr, format="%(asctime)s %(message)s", datefmt="%H:%M:%S"
    )

    def arguments(parser: argparse.ArgumentParser) -> None:
        parser.add_argument("--job", type=_job, required=True, metavar="FILE", help="the values, as JSON")
        for option, text in files.items():
            parser.add_argument(
                f"--{option}",
                type=Path,
                nargs="*" if text.endswith("…") else None,
                required=True,
                metavar="PATH",
                help=text,
            )

    personal(work, arguments, expected)


def personal(
    work: Callable[..., None],
    arguments: Callable[[argparse.ArgumentParser], None],
    expected: tuple[type[Exception], ...] = (),
) -> None:
    """Run `work` with what `arguments` has the command line hold, as this process's command.

    Errors of the types of `expected`, and those of storage and configuration, are one line and exit
    code 1; any other leaves its traceback. SIGTERM ends the process as `sys.exit` does, so
    that whatever is open is closed.
    """
    signal.signal(signal.SIGTERM, _terminate)
    # A shell that starts something in the background has it ignore SIGINT; Ctrl-C must reach us all the same.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    parser = argparse.ArgumentParser(prog=_name(), description=sys.modules["__main__"].__doc__)
    arguments(parser)
    given = vars(parser.parse_args())
    try:
        work(**given)
    except (*EXPECTED, *expected) as error:
        print(f"{_name()}: {error}", file=sys.stderr)
        sys.exit(1)
    except KeyboardInterrupt:
        print(f"{_name()}: interrupted", file=sys.stderr)
        sys.exit(INTERRUPTED)


def _name() -> str:
    """As the shell has it: `flexsurr learn-load` for the module flexsurr.cli.learn_load."""
    spec = sys.modules["__main__"].__spec__
    return f"flexsurr {spec.name.rpartition('.')[2].replace('_', '-')}" if spec else "command"


def _job(text: str) -> Job:
    try:
        content = json.loads(Path(text).read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise argparse.ArgumentTypeError(f"{text} is no job: {error}") from None
    if not isinstance(content, dict):
        raise argparse.ArgumentTypeError(f"{text} is no job: not a JSON object")
    return content


def _terminate(number: int, frame: FrameType | None) -> None:
    sys.exit(TERMINATED)
