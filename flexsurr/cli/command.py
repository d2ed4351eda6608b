"""What every command has in common: how it is declared, its arguments, its log, and how it ends."""

import argparse
import json
import logging
import os
import signal
import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import wraps
from pathlib import Path
from pickle import UnpicklingError
from types import FrameType
from typing import Any, TypeVar

from flexsurr.config.errors import ConfigurationError
from flexsurr.kernel_cache import NotCompiled
from flexsurr.storage import DamagedFile, StorageError

Job = Mapping[str, Any]
Work = TypeVar("Work", bound=Callable[..., None])
EXPECTED: tuple[type[Exception], ...] = (StorageError, ConfigurationError, NotCompiled)

INTERRUPTED = 130
TERMINATED = 143


@dataclass(frozen=True)
class Command:
    """What it does, the arguments that it takes, and the errors that are one line."""

    work: Callable[..., None]
    arguments: Callable[[argparse.ArgumentParser], None]
    expected: tuple[type[Exception], ...]


COMMANDS: dict[str, Command] = {}
"""The commands of all modules that have been imported, by their names in the shell."""


def for_rules(*expected: type[Exception], **files: str) -> Callable[[Work], Work]:
    """Declare `work(job, <file>, …)` a command of the workflow, named as the function is.

    `files` says of each file what it holds; a parameter that is a list takes any number. The command logs
    with the time of day, and says of a damaged file how it is made again.
    """

    def declare(work: Work) -> Work:
        def arguments(parser: argparse.ArgumentParser) -> None:
            parser.add_argument("--job", type=_job, required=True, metavar="FILE", help="the values, as JSON")
            for option, text in files.items():
                number = None if work.__annotations__[option] is Path else "*"
                parser.add_argument(
                    f"--{option}", type=Path, nargs=number, required=True, metavar="PATH", help=text
                )

        @wraps(work)
        def logged(**values: Any) -> None:
            logging.basicConfig(
                level=logging.INFO, stream=sys.stderr, format="%(asctime)s %(message)s", datefmt="%H:%M:%S"
            )
            try:
                work(**values)
            except DamagedFile as error:
                raise StorageError(f"{error}; delete it, and snakemake makes it again") from None

        COMMANDS[_name(work)] = Command(logged, arguments, expected)
        return work

    return declare


def for_people(
    arguments: Callable[[argparse.ArgumentParser], None], *expected: type[Exception]
) -> Callable[[Work], Work]:
    """Declare `work` a command for people, named as the function is, with what `arguments` has them write."""

    def declare(work: Work) -> Work:
        COMMANDS[_name(work)] = Command(work, arguments, expected)
        return work

    return declare


def run(name: str, purpose: str, arguments: Sequence[str]) -> None:
    """Run a command with the `arguments` of the shell, as this process's work.

    The errors that it expects, those of storage and configuration, and what the machine refuses (a full disk,
    a file that may not be read, memory) are one line and exit code 1; any other leaves its traceback.
    SIGTERM ends the process as `sys.exit` does, so that whatever is open is closed.
    """
    signal.signal(signal.SIGTERM, _terminate)
    # A shell that starts something in the background has it ignore SIGINT; Ctrl-C must reach us all the same.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    command, called = COMMANDS[name], f"flexsurr {name}"
    parser = argparse.ArgumentParser(prog=called, description=purpose)
    command.arguments(parser)
    given = vars(parser.parse_args(arguments))
    try:
        command.work(**given)
    except (*EXPECTED, *command.expected) as error:
        print(f"{called}: {error}", file=sys.stderr)
        sys.exit(1)
    except (OSError, MemoryError) as error:
        print(f"{called}: {_refusal(error)}", file=sys.stderr)
        sys.exit(1)
    except (UnpicklingError, EOFError):
        # Nothing of ours is pickled; numba keeps its machine code so.
        folder = os.environ.get("NUMBA_CACHE_DIR", "NUMBA_CACHE_DIR")
        print(
            f"{called}: {folder}: damaged machine code; delete it, and it is compiled anew", file=sys.stderr
        )
        sys.exit(1)
    except KeyboardInterrupt:
        print(f"{called}: interrupted", file=sys.stderr)
        sys.exit(INTERRUPTED)


def _name(work: Callable[..., None]) -> str:
    return work.__name__.replace("_", "-")


def _refusal(error: OSError | MemoryError) -> str:
    """What the machine has refused, on one line."""
    if isinstance(error, OSError) and error.strerror:
        return f"{error.filename}: {error.strerror}" if error.filename else error.strerror
    return " ".join(str(error).split()) or "out of memory"


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
