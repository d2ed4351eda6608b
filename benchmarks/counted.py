"""What one right-hand side takes, counted: arithmetic of its formulas, instructions of its machine code.

    python benchmarks/counted.py

Counts do not depend on what else the machine does. Operations are those of the source
(`flexsurr.evaluation.operations`), the same everywhere: the floor, at one an instruction, which only vectors
and fused products go below. Instructions depend on LLVM and on the processor's vectors. They are counted one
by one: a child process calls compiled code under ptrace, a step at a time; what lies in memory that belongs
to no file is the code of numba; where objdump is there, arithmetic, moves, and the rest (whole numbers,
addresses, branches, calls) are told apart. Linux on x86-64 alone. Hardware counters, which virtual machines
often lack, are not needed.
"""

import ctypes
import os
import platform
import re
import shutil
import signal
import subprocess
import sys
import tempfile
from collections import Counter

import numpy as np
from beam_right_hand_sides import call_repeatedly
from cantilever import cantilever_model
from run import MISSING
from surrogates import HNN, MLP, even_network, network, polynomial
from timing import compare
from wing import basis, wing_model

from flexsurr.config.study import InitialConditions
from flexsurr.evaluation.operations import operations
from flexsurr.surrogates import compiled
from flexsurr.training.configuration_samples import configuration_samples
from flexsurr.training.inverse_dynamics import fit_port_hamiltonian

FEW, MANY = 2, 6
"""Calls: what the two runs differ by is theirs alone."""
TIMED = 2000
TRACE_ME, PEEK_USER, SINGLE_STEP = 0, 3, 9
RIP = 16 * 8  # <sys/user.h>: the place of the instruction pointer among the registers
LANES = {"x": 2, "y": 4, "z": 8}
"""Doubles in a register xmm, ymm or zmm."""
MOVES = re.compile(r"^v?mov|^v?p?broadcast|^v(?:extract|insert|shuf|perm|unpck|gather)")
"""From and to memory and between registers."""
ARITHMETIC = re.compile(r"^v?(?:add|sub|mul|div|sqrt)([ps])d$|^v?fn?m(?:add|sub)\d*([ps])d$")

ptrace = ctypes.CDLL(None, use_errno=True).ptrace
ptrace.argtypes = [ctypes.c_long, ctypes.c_long, ctypes.c_void_p, ctypes.c_void_p]
ptrace.restype = ctypes.c_long


def addresses(call) -> Counter:
    """How often the instruction at each address is executed in `call`, by a child under ptrace."""
    child = os.fork()
    if child == 0:
        ptrace(TRACE_ME, 0, None, None)
        os.kill(os.getpid(), signal.SIGSTOP)
        call()
        os.kill(os.getpid(), signal.SIGSTOP)
        os._exit(0)
    os.waitpid(child, 0)
    found: Counter = Counter()
    while True:
        if ptrace(SINGLE_STEP, child, None, None) != 0:
            raise OSError(ctypes.get_errno(), "no process may be stepped here")
        _, status = os.waitpid(child, 0)
        if not os.WIFSTOPPED(status) or os.WSTOPSIG(status) != signal.SIGTRAP:
            break
        found[ptrace(PEEK_USER, child, RIP, None) & (2**64 - 1)] += 1
    os.kill(child, signal.SIGKILL)
    os.waitpid(child, 0)
    return found


def jitted() -> list[range]:
    """Memory of this process that can be executed and is no file's."""
    with open("/proc/self/maps") as maps:
        rows = [line.split() for line in maps]
    return [
        range(*(int(end, 16) for end in row[0].split("-"))) for row in rows if "x" in row[1] and len(row) == 5
    ]


def one_call(kernel, x, work) -> Counter:
    """The instructions of one right-hand side, by address."""
    dx = np.empty_like(x)
    call_repeatedly(kernel, 0.0, x, dx, work, 1)
    few, many = (
        addresses(lambda n=n: call_repeatedly(kernel, 0.0, x.copy(), dx, work, n)) for n in (FEW, MANY)
    )
    code = jitted()
    found = {
        at: (many[at] - few[at]) / (MANY - FEW)
        for at in many
        if many[at] > few[at] and any(at in part for part in code)
    }
    return Counter(found)


def told_apart(found: Counter) -> dict[str, float]:
    """What these instructions are, and what floating-point operations they do, by the registers they fill.

    Nothing where objdump is not there.
    """
    if not shutil.which("objdump"):
        return {}
    of = dict.fromkeys(("executed_operations", "of_arithmetic", "of_moves"), 0.0)
    for at, times in found.items():
        mnemonic, operands = disassembled(at)
        match = ARITHMETIC.match(mnemonic)
        if match:
            register = re.findall(r"%([xyz])mm", operands)
            packed = "p" in match.groups()
            fused = 2 if match.group(2) else 1
            of["executed_operations"] += times * fused * (LANES[register[-1]] if packed else 1)
            of["of_arithmetic"] += times
        elif MOVES.match(mnemonic):
            of["of_moves"] += times
    return of


def disassembled(at: int) -> tuple[str, str]:
    """Mnemonic and operands of the instruction at an address of this process."""
    if at not in _known:
        begin = at - at % 4096
        image = ctypes.string_at(at, min(4096 - (at - begin), 15))
        with tempfile.NamedTemporaryFile() as file:
            file.write(image)
            file.flush()
            words = ["objdump", "-D", "-b", "binary", "-m", "i386:x86-64", "--no-show-raw-insn", file.name]
            listing = subprocess.run(words, capture_output=True, text=True, check=True).stdout
        first = next(line for line in listing.splitlines() if re.match(r"\s+0:\t", line))
        mnemonic, *operands = first.split("\t")[1].split(None, 1)
        _known[at] = mnemonic, " ".join(operands)
    return _known[at]


_known: dict[int, tuple[str, str]] = {}


def models() -> dict[str, tuple]:
    """Of each its model and a state."""
    pair, six = np.array([0.2, 1.0]), np.full(6, 0.3)
    of_cantilever = {
        "cantilever, reduced model": cantilever_model("hamiltonian"),
        "polynomial H, degree 6": polynomial(6, "even"),
        "polynomial H, degree 10": polynomial(10, "even"),
        "even HNN, 4 half_log": even_network(4, "half_log"),
        "even HNN, 8 half_log": even_network(8, "half_log"),
        "HNN, 16 half_log": network(HNN, (16,), "half_log"),
        "HNN, 32 half_log": network(HNN, (32,), "half_log"),
        "MLP, 32 tanh": network(MLP, (32,), "tanh"),
    }
    samples = configuration_samples(basis(), "hamiltonian", InitialConditions(), 500)
    of_wing = {"wing, reduced model": wing_model("hamiltonian")}
    of_wing |= {
        f"port-Hamiltonian, degree {n}": compiled(fit_port_hamiltonian(samples, n)) for n in (4, 6, 8)
    }
    return {name: (model, pair) for name, model in of_cantilever.items()} | {
        name: (model, six) for name, model in of_wing.items()
    }


def main() -> int:
    if sys.platform != "linux" or platform.machine() != "x86_64":
        print("left out: instructions are counted on Linux and x86-64 alone")
        return MISSING
    chosen = models()
    calls, counts = {}, {}
    for name, (model, x) in chosen.items():
        values = model.kernel, 0.0, x.copy(), np.empty_like(x), np.empty(model.work_size), TIMED
        calls[name] = lambda values=values: call_repeatedly(*values)
        found = one_call(model.kernel, x, np.empty(model.work_size))
        floor, taken = operations(model, x), sum(found.values())
        counts[name] = {"operations": floor, "instructions": taken, "over_floor": taken / floor}
        counts[name] |= told_apart(found)
    what = "one right-hand side, and what it takes"
    timings = compare(what, calls, repeats=20, counts=TIMED, more=counts)
    columns = list(next(iter(counts.values())))
    print(f"{'':<30}" + "".join(f"{column:>21}" for column in columns) + f"{'ns':>8}")
    for name, of in counts.items():
        cells = "".join(f"{of[column]:>21.4g}" for column in columns)
        print(f"{name:<30}{cells}{1e9 * timings[name].median_s:>8.0f}", flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
