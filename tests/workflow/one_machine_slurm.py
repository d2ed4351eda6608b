"""A Slurm of this machine alone, in a folder: the machine's own configuration is left alone."""

import getpass
import os
import secrets
import shutil
import socket
import subprocess
import time
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path

CLIENTS = ("sbatch", "srun", "squeue", "scancel", "sinfo", "scontrol", "sacct", "sacctmgr")
WHERE = f"{os.environ['PATH']}{os.pathsep}/usr/sbin"
PATIENCE_S = 60

CONFIGURATION = """
ClusterName=one-machine
SlurmctldHost={node}(127.0.0.1)
SlurmctldPort={controller_port}
SlurmdPort={node_port}
AuthType=auth/munge
AuthInfo=socket={folder}/munge.socket
SlurmUser={user}
SlurmdUser={user}
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
SlurmdParameters=config_overrides
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core_Memory
MpiDefault=none
ReturnToService=2
MinJobAge=86400
NodeName={node} NodeAddr=127.0.0.1 CPUs={cpus} RealMemory={memory_mb}
PartitionName=main Nodes=ALL Default=YES MaxTime=INFINITE State=UP
"""


@dataclass(frozen=True)
class Job:
    """What the queue says of a job: its comment, whether its node was its own, processors, start and end."""

    comment: str
    alone: bool
    processors: int
    start: str
    end: str


@dataclass(frozen=True)
class Slurm:
    """A Slurm that runs: `commands` is the folder of the clients that talk to it."""

    commands: Path

    def jobs(self) -> list[Job]:
        """Every job since it was started."""
        fields = "%k|%h|%C|%S|%e"
        listed = subprocess.run(
            [self.commands / "squeue", "--states=all", "--noheader", f"--format={fields}"],
            capture_output=True,
            text=True,
            check=True,
        )
        rows = [line.split("|") for line in listed.stdout.splitlines()]
        return [Job(comment, share == "NO", int(cpus), *span) for comment, share, cpus, *span in rows]


@contextmanager
def one_machine_slurm(folder: Path) -> Iterator[Slurm]:
    """munged, slurmctld and slurmd with all of their files in `folder`, until the block ends."""
    for name in ("state", "spool", "commands"):
        (folder / name).mkdir()
    node = socket.gethostname().partition(".")[0]
    ports = _free_ports(2)
    memory = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") // 2**20
    configuration = folder / "slurm.conf"
    configuration.write_text(
        CONFIGURATION.format(
            node=node,
            controller_port=ports[0],
            node_port=ports[1],
            folder=folder,
            user=getpass.getuser(),
            cpus=os.cpu_count(),
            memory_mb=memory,
        )
    )
    for client in CLIENTS:
        # Not by SLURM_CONF alone: Snakemake's plugin drops the variables of Slurm.
        command = folder / "commands" / client
        command.write_text(f'#!/bin/sh\nSLURM_CONF="{configuration}" exec {_program(client)} "$@"\n')
        command.chmod(0o755)
    key = folder / "munge.key"
    key.write_bytes(secrets.token_bytes(128))
    key.chmod(0o400)
    files = {"socket": "munge.socket", "pid-file": "munge.pid", "log-file": "munge.log", "seed-file": "seed"}
    munge = [f"--{option}={folder / name}" for option, name in files.items()]
    slurm = Slurm(folder / "commands")
    with ExitStack() as running:
        # forced, since the folder of the socket is not open to everyone
        running.enter_context(
            _daemon("munged", ["--foreground", "--force", f"--key-file={key}", *munge], folder)
        )
        _wait_for((folder / "munge.socket").exists)
        running.enter_context(_daemon("slurmctld", ["-D", "-c", "-f", str(configuration)], folder))
        running.enter_context(_daemon("slurmd", ["-D", "-N", node, "-f", str(configuration)], folder))
        _wait_for(lambda: _is_idle(slurm))
        yield slurm


def _is_idle(slurm: Slurm) -> bool:
    said = subprocess.run(
        [slurm.commands / "sinfo", "--noheader", "--format=%T"], capture_output=True, text=True
    )
    return said.stdout.strip() == "idle"


@contextmanager
def _daemon(name: str, options: Sequence[str], folder: Path) -> Iterator[None]:
    with (folder / f"{name}.out").open("w") as output:
        process = subprocess.Popen(
            [_program(name), *options], stdout=output, stderr=subprocess.STDOUT, start_new_session=True
        )
    try:
        yield
    finally:
        process.terminate()
        try:
            process.wait(PATIENCE_S)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()


def _program(name: str) -> str:
    found = shutil.which(name, path=WHERE)
    assert found, f"no {name} on this machine: make slurm installs it"
    return found


def _free_ports(count: int) -> list[int]:
    with ExitStack() as held:
        probes = [held.enter_context(socket.socket()) for _ in range(count)]
        for probe in probes:
            probe.bind(("127.0.0.1", 0))
        return [probe.getsockname()[1] for probe in probes]


def _wait_for(happens) -> None:
    end = time.monotonic() + PATIENCE_S
    while not happens():
        assert time.monotonic() < end, "Slurm did not start"
        time.sleep(0.1)
