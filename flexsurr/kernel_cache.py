"""Where numba keeps the machine code of the kernels between processes.

An integrator's machine code holds the equations it steps, but numba looks only at the integrator's own
file to see whether the code is stale: after an edit of the equations it would go on running the old ones.
So the folder it uses is named by a digest of every source that may end up in machine code, and an edit
means another folder.

Kernels defined outside this package need a folder of their own: numba could no longer read the package's
in a process that does not know their modules. Their author says, before importing more of flexsurr,

    flexsurr.kernel_cache.activate("my_kernels.py")

Standard library only, and before numba is imported, since numba reads its settings on import.
"""

import hashlib
import os
import shutil
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

PACKAGE = Path(__file__).parent
KERNEL_FLOORS = ("simulation", "beam", "surrogates", "aerodynamics", "training", "flight")
KEPT_UNUSED_DAYS = 14.0

_VARIABLE = "NUMBA_CACHE_DIR"
_PREFIX = "flexsurr-kernels-"

_outside: set[Path] = set()


class NotCompiled(TypeError):
    """Python has called what only machine code can run; the message says what is missing."""


def not_compiled(what: str, function: str, kernel: object) -> NotCompiled:
    """The error of `function`, which numba replaces by the equations (or `what` they are) of a kernel."""
    if os.environ.get("NUMBA_DISABLE_JIT", "0") not in ("", "0"):
        return NotCompiled(
            "NUMBA_DISABLE_JIT is set, and compiled models and integrators need numba's compiler: unset it, "
            "or step described or numpy models by SciPy's integrators"
        )
    name = type(kernel).__name__
    return NotCompiled(f"no {what} is registered for {name}; call {function} from compiled code")


def digest(*outside: Path, package: Path = PACKAGE) -> str:
    """Sixteen hex digits of the floors that hold kernels and of sources from outside the package."""
    sha = hashlib.sha256()
    inside = [source for floor in KERNEL_FLOORS for source in sorted((package / floor).rglob("*.py"))]
    for source in inside + sorted(outside):
        name = source.relative_to(package) if source in inside else source
        sha.update(name.as_posix().encode() + b"\0")
        sha.update(source.read_bytes() + b"\0")
    return sha.hexdigest()[:16]


def activate(*outside: str | Path, package: Path = PACKAGE) -> None:
    """Tell numba the folder of the package's sources and those `outside`, unless the user has chosen one.

    A folder that a parent process chose this way does not count: the sources may have changed since.
    Raises RuntimeError if kernels from outside come too late, after the integrators have been imported.
    """
    _outside.update(Path(source).resolve() for source in outside)
    numba = sys.modules.get("numba")
    chosen = os.environ.get(_VARIABLE) or (numba.config.CACHE_DIR if numba else "")
    if chosen and not Path(chosen).name.startswith(_PREFIX):
        return
    if outside and "flexsurr.simulation" in sys.modules:
        raise RuntimeError("call flexsurr.kernel_cache.activate before importing flexsurr.simulation")
    folder = str(_folder(_PREFIX + digest(*_outside, package=package), package))
    os.environ[_VARIABLE] = folder
    if numba:
        numba.config.CACHE_DIR = folder


def keeps(kernel_class: type) -> bool:
    """Whether the machine code of a kernel's equations is kept: not of a script's, compiled in each process.

    Raises RuntimeError for a kernel from outside whose code would go into the package's folder.
    """
    module = sys.modules.get(kernel_class.__module__)
    source = getattr(module, "__file__", None)
    if kernel_class.__module__ == "__main__" or source is None:
        return False
    path = Path(source).resolve()
    ours = Path(os.environ.get(_VARIABLE, "")).name.startswith(_PREFIX)
    if ours and path not in _outside and not path.is_relative_to(PACKAGE):
        raise RuntimeError(
            f"{kernel_class.__name__} is defined outside flexsurr: call flexsurr.kernel_cache.activate"
            f"({str(path)!r}) before importing flexsurr.simulation, or set {_VARIABLE} to a folder of yours"
        )
    return True


def _folder(name: str, package: Path) -> Path:
    """The folder `name` in the first place that can be written to, its time of last use set to now."""
    for place in _places(package):
        folder = place / name
        try:
            is_new = not folder.is_dir()
            folder.mkdir(parents=True, exist_ok=True)
            os.utime(folder)
            tempfile.TemporaryFile(dir=folder).close()
        except OSError:
            continue
        if is_new:
            _prune(place)
        return folder
    return Path(tempfile.mkdtemp(prefix=name + "-"))


def _places(package: Path) -> Iterator[Path]:
    yield package / "__pycache__"
    if "XDG_CACHE_HOME" in os.environ:
        yield Path(os.environ["XDG_CACHE_HOME"]) / "flexsurr"
    try:
        yield Path.home() / ".cache" / "flexsurr"
    except RuntimeError:  # a user without a home
        return


def _prune(place: Path) -> None:
    """Remove the folders of other sources that no process has started with for some days."""
    oldest = time.time() - KEPT_UNUSED_DAYS * 86400.0
    for folder in place.glob(_PREFIX + "*"):
        try:
            stale = folder.stat().st_mtime < oldest
        except OSError:  # another process was faster
            continue
        if stale:
            shutil.rmtree(folder, ignore_errors=True)
