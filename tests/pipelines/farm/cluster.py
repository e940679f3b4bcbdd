"""A Slurm cluster on this machine alone: munged, slurmctld, and a slurmd for each node, with their ports, key and
folders.

Each daemon is process 1 of a process namespace. When it is killed, all processes that it started die too, as on a
machine that loses power. Another Slurm on this machine is not affected."""

import os
import pathlib
import shutil
import signal
import socket
import subprocess
import tempfile
import time

START_SECONDS = 40
# Seconds until a node counts as dead, and until a requeued task starts: the least that Slurm allows. The defaults are
# 300 and 120.
DEAD_AFTER_SECONDS = 5
CREDENTIAL_SECONDS = 5

CONFIGURATION = """\
ClusterName=polyrecon_test
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={ports[0]}
SlurmUser=root
AuthType=auth/munge
AuthInfo=socket={folder}/munge.socket,cred_expire={credential}
StateSaveLocation={folder}/state
SlurmctldPidFile={folder}/slurmctld.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdPidFile={folder}/slurmd.%n.pid
SlurmdLogFile={folder}/slurmd.%n.log
SlurmdSpoolDir={folder}/spool.%n
SlurmdParameters=config_overrides
SlurmdTimeout={dead}
MessageTimeout=5
ReturnToService=2
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SwitchType=switch/none
MpiDefault=none
SchedulerType=sched/builtin
SchedulerParameters=batch_sched_delay=0,sched_interval=1,sched_min_interval=0
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU_Memory
AccountingStorageType=accounting_storage/none
JobAcctGatherType=jobacct_gather/none
GresTypes=gpu
"""
NODE = "NodeName={name} NodeHostname={host} NodeAddr=127.0.0.1 Port={port} CPUs=1 RealMemory={memory}{gpu}\n"


def free_ports(count):
    sockets = [socket.socket() for _ in range(count)]
    try:
        for one in sockets:
            one.bind(("127.0.0.1", 0))
        return [one.getsockname()[1] for one in sockets]
    finally:
        for one in sockets:
            one.close()


def can_run():
    """Whether this process may start the daemons: as root, in new process namespaces."""
    test = ["unshare", "--pid", "--fork", "--kill-child", "--mount-proc", "true"]
    return os.geteuid() == 0 and subprocess.run(test, capture_output=True).returncode == 0


class Cluster:
    """A context manager. Slurm's commands reach the cluster with its `environment`.

    gpu_node: the node that has a graphics card. Slurm only checks that the file of the card exists."""

    def __init__(self, nodes, megabytes, gpu_node):
        self.nodes, self.megabytes, self.gpu_node, self.daemons = nodes, megabytes, gpu_node, {}

    def __enter__(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="polyrecon_slurm_"))
        try:
            self._configure()
            self._start(
                "munge", ["munged", "--foreground", f"--socket={self.folder}/munge.socket", *self._munge_files()]
            )
            self._wait(lambda: (self.folder / "munge.socket").exists())
            self._start("controller", ["slurmctld", "-D", "-f", self.folder / "slurm.conf"])
            for node in self.nodes:
                self.boot(node)
            self.wait_idle()
        except BaseException:
            self.__exit__()
            raise
        return self

    def __exit__(self, *_):
        for name in reversed(list(self.daemons)):
            self.kill(name)
        shutil.rmtree(self.folder)

    def boot(self, node):
        self._start(node, ["slurmd", "-D", "-N", node, "-f", self.folder / "slurm.conf"])

    def kill(self, name):
        """Kills a daemon and every process of its namespace."""
        unshare = self.daemons.pop(name)
        if unshare.poll() is not None:
            return
        for child in pathlib.Path(f"/proc/{unshare.pid}/task/{unshare.pid}/children").read_text().split():
            os.kill(int(child), signal.SIGKILL)
        unshare.wait()

    def wait_idle(self):
        self._wait(lambda: self.states() == dict.fromkeys(self.nodes, "idle"))

    def run(self, *words):
        done = subprocess.run(words, env=self.environment, capture_output=True, text=True, timeout=60)
        return done.stdout if done.returncode == 0 else ""

    def states(self):
        return dict(line.split() for line in self.run("sinfo", "-h", "-N", "-o", "%N %T").splitlines())

    def _configure(self):
        self.folder.chmod(0o755)  # Every user must reach the socket of munged.
        ports = free_ports(1 + len(self.nodes))
        host = socket.gethostname()
        text = CONFIGURATION.format(
            host=host, ports=ports, folder=self.folder, dead=DEAD_AFTER_SECONDS, credential=CREDENTIAL_SECONDS
        )
        for node, port in zip(self.nodes, ports[1:]):
            (self.folder / f"spool.{node}").mkdir()
            gpu = " Gres=gpu:1" if node == self.gpu_node else ""
            text += NODE.format(name=node, host=host, port=port, memory=self.megabytes, gpu=gpu)
        text += "PartitionName=main Nodes=ALL Default=YES MaxTime=INFINITE State=UP\n"
        (self.folder / "state").mkdir()
        (self.folder / "slurm.conf").write_text(text)
        (self.folder / "gres.conf").write_text(f"NodeName={self.gpu_node} Name=gpu File=/dev/null\n")
        self.environment = dict(os.environ, SLURM_CONF=str(self.folder / "slurm.conf"))

    def _munge_files(self):
        key = self.folder / "munge.key"
        key.write_bytes(os.urandom(128))
        key.chmod(0o400)
        return [f"--key-file={key}", *(f"--{kind}-file={self.folder}/munge.{kind}" for kind in ("pid", "log", "seed"))]

    def _start(self, name, words):
        with open(self.folder / f"{name}.out", "a") as log:
            self.daemons[name] = subprocess.Popen(
                ["unshare", "--pid", "--fork", "--kill-child", "--mount-proc", *map(str, words)],
                env=self.environment,
                stdin=subprocess.DEVNULL,
                stdout=log,
                stderr=log,
                start_new_session=True,
            )

    def _wait(self, ready):
        end = time.monotonic() + START_SECONDS
        while not ready():
            for name, daemon in self.daemons.items():
                if daemon.poll() is not None:
                    raise RuntimeError(f"{name} ended: {(self.folder / f'{name}.out').read_text()}")
            if time.monotonic() > end:
                raise RuntimeError(f"no cluster within {START_SECONDS} s: {self.states()}")
            time.sleep(0.1)
