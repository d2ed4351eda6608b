"""What every command has in common: its arguments, its log, and how it ends."""

import argparse
import json
import logging
import os
import signal
import sys
from collections.abc import Callable, Mapping
from pathlib import Path
from pickle import UnpicklingError
from types import FrameType
from typing import Any

from flexsurr.config.errors import ConfigurationError
from flexsurr.kernel_cache import NotCompiled
from flexsurr.storage import DamagedFile, StorageError

Job = Mapping[str, Any]
EXPECTED: tuple[type[Exception], ...] = (StorageError, ConfigurationError, NotCompiled)

INTERRUPTED = 130
TERMINATED = 143


def command(
    work: Callable[..., None],
    files: Mapping[str, str],
    expected: tuple[type[Exception], ...] = (),
) -> None:
    """Run `work(job, <file>, …)` as this process's command for the workflow, and end the process.

    `files` maps names of options to what they hold; where the text ends in "…" the option takes any number.
    Ends as `personal` does, logs with the time of day, and says of a damaged file how it is made again.
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

    def working(**values: Any) -> None:
        try:
            work(**values)
        except DamagedFile as error:
            raise StorageError(f"{error}; delete it, and snakemake makes it again") from None

    personal(working, arguments, expected)


def personal(
    work: Callable[..., None],
    arguments: Callable[[argparse.ArgumentParser], None],
    expected: tuple[type[Exception], ...] = (),
) -> None:
    """Run `work` with what `arguments` has the command line hold, as this process's command.

    Errors of the types of `expected`, those of storage and configuration, and what the machine refuses (a
    full disk, a file that may not be read, memory) are one line and exit code 1; any other leaves its
    traceback. SIGTERM ends the process as `sys.exit` does, so that whatever is open is closed.
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
    except (OSError, MemoryError) as error:
        print(f"{_name()}: {_refusal(error)}", file=sys.stderr)
        sys.exit(1)
    except (UnpicklingError, EOFError):
        # Nothing of ours is pickled; numba keeps its machine code so.
        folder = os.environ.get("NUMBA_CACHE_DIR", "NUMBA_CACHE_DIR")
        print(
            f"{_name()}: {folder}: damaged machine code; delete it, and it is compiled anew", file=sys.stderr
        )
        sys.exit(1)
    except KeyboardInterrupt:
        print(f"{_name()}: interrupted", file=sys.stderr)
        sys.exit(INTERRUPTED)


def _name() -> str:
    """As the shell has it: `flexsurr learn-load` for the module flexsurr.cli.learn_load."""
    spec = sys.modules["__main__"].__spec__
    return f"flexsurr {spec.name.rpartition('.')[2].replace('_', '-')}" if spec else "command"


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
