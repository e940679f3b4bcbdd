"""Runs a command of the program on hostile input and says what is wrong with how it ended."""

import os
import pathlib
import re
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time

DOCUMENTED = {0, 2, 3, 4, 5, 6, 8, 33}
INTERNAL = 1
# What a terminal or Open Job Description would act on: controls but for the end of a line, and marks of direction.
CONTROLS = re.compile("[\x00-\x09\x0b-\x1f\x7f-\x9f\u2028\u2029\u202a-\u202e\u2066-\u2069]")
MEGABYTE = 2**20
SECONDS = 300  # of the clock, on a busy machine
PROCESSOR_SECONDS = 60


class Outcome:
    """How a run ended: exit code (negative: a signal), texts, and the largest resident size in bytes."""

    def __init__(self, command, code, out, err, memory):
        self.command, self.code, self.out, self.err, self.memory = command, code, out, err, memory

    def faults(self, limit, codes=DOCUMENTED):
        """What is wrong, as a list of texts. `limit` is the largest size that is allowed, in bytes."""
        wrong = []
        if self.code < 0:
            wrong.append(f"ended by signal {signal.Signals(-self.code).name}")
        elif self.code not in codes:
            wrong.append(f"exit code {self.code}")
        lines = [line for line in self.err.split(b"\n") if line and not self._is_progress(line)]
        most = 1 if self.code > 0 else 0
        if self._many_frames():  # A line for each frame that is missing or broken, and one for the whole.
            most = len(lines)
        if any(not line.startswith(b"polyrecon: ") for line in lines) or not bool(self.code) <= len(lines) <= most:
            wrong.append(f"standard error: {self.err[:300]!r}")
        for name, text in (("output", self.out), ("error", self.err)):
            if CONTROLS.search(text.decode("utf-8", "replace")):
                wrong.append(f"control characters on standard {name}")
            try:
                text.decode()
            except UnicodeDecodeError:
                wrong.append(f"standard {name} is not UTF-8")
            if re.search(rb"^(@polyrecon|openjd_(env|fail|unset_env|redacted_env|session|status: forged))", text, re.M):
                wrong.append(f"a forged line on standard {name}")
        if self.memory > limit:
            wrong.append(f"{self.memory // MEGABYTE} MB where {limit // MEGABYTE} MB are allowed")
        return wrong

    def _is_progress(self, line):
        """Whether --progress wrote the line, or a run of minutes, as it does into a log."""
        begins = {"json": b"{", "openjd": b"openjd_"}
        written = tuple(begin for style, begin in begins.items() if style in self.command)
        return line.startswith(written) or re.match(rb"polyrecon: +\d+ %, ", line) is not None

    def _many_frames(self):
        return b"frames are missing or broken" in self.err


class Program:
    """The program, run in a folder of its own. Plain runs go to `server` where it is given: server.cpp, built."""

    def __init__(self, path, folder, server=None):
        self.path, self.folder = os.path.abspath(path), pathlib.Path(folder)
        self.server = server and subprocess.Popen(
            [os.path.abspath(server)], stdin=subprocess.PIPE, stdout=subprocess.PIPE
        )
        self.texts = tempfile.TemporaryDirectory(prefix="polyrecon_attacks_")

    def close(self):
        """Ends the server."""
        if self.server:
            self.server.communicate()
        self.texts.cleanup()

    def run(self, arguments, before=None, meanwhile=None, limits=()):
        """Runs the program; before() runs in the child, meanwhile(process) while it works, `limits` are pairs for
        setrlimit."""
        command = [self.path, *(os.fspath(argument) for argument in arguments)]
        if self.server and not (before or meanwhile or limits):
            return self._served(command)

        def prepare():
            os.setpgid(0, 0)
            os.nice(1)
            resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
            resource.setrlimit(resource.RLIMIT_CPU, (PROCESSOR_SECONDS, PROCESSOR_SECONDS))
            for kind, value in limits:
                resource.setrlimit(kind, (value, value))
            if before:
                before()

        with tempfile.TemporaryFile() as out, tempfile.TemporaryFile() as err:
            process = subprocess.Popen(
                command, stdin=subprocess.DEVNULL, stdout=out, stderr=err, cwd=self.folder, preexec_fn=prepare
            )
            if meanwhile:
                meanwhile(process)
            status, usage = _wait(process)
            texts = []
            for file in (out, err):
                file.seek(0)
                texts.append(file.read())
        return Outcome(command, status, *texts, usage.ru_maxrss * 1024)

    def _served(self, command):
        texts = [pathlib.Path(self.texts.name) / name for name in ("out", "err")]
        request = b"".join(os.fsencode(text) + b"\0" for text in (self.folder, *texts, *command[1:]))
        self.server.stdin.write(b"%d\n" % len(request) + request)
        self.server.stdin.flush()
        status, kilobytes = map(int, self.server.stdout.readline().split())
        out, err = (text.read_bytes() for text in texts)
        return Outcome(command, os.waitstatus_to_exitcode(status), out, err, kilobytes * 1024)

    def clear(self):
        """Empties the folder."""
        for path in self.folder.iterdir():
            if path.is_dir() and not path.is_symlink():
                shutil.rmtree(path)
            else:
                path.unlink()

    def left_over(self):
        """Temporaries that are in the folder or below it."""
        return [str(path) for path in self.folder.rglob("*") if ".polyrecon-" in path.name]


def _wait(process):
    """Exit code and usage of the process. If it hangs it is killed, which counts as ended by SIGALRM."""
    end = time.monotonic() + SECONDS
    while time.monotonic() < end:
        pid, status, usage = os.wait4(process.pid, os.WNOHANG)
        if pid:
            process.returncode = os.waitstatus_to_exitcode(status)
            return process.returncode, usage
        time.sleep(0.002)
    os.kill(process.pid, signal.SIGKILL)
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    return -signal.SIGALRM, usage


class Tally:
    """Counts attacks, prints those that got through, and keeps their inputs."""

    def __init__(self, name, keep, seconds):
        self.name, self.keep = name, pathlib.Path(keep) if keep else None
        self.inputs = self.runs = self.through = 0
        self.end = time.monotonic() + seconds
        self.codes = {}

    def count(self, outcome, wrong, label, files=()):
        self.runs += 1
        self.codes[outcome.code] = self.codes.get(outcome.code, 0) + 1
        if self.runs % 1000 == 0:
            print(f"{self.name}: {self.runs} runs so far", file=sys.stderr, flush=True)
        if not wrong:
            return
        self.through += 1
        print(f"THROUGH {self.name} {label}: {'; '.join(wrong)}\n    {_shown(outcome.command)}", flush=True)
        if self.keep:
            kept = self.keep / f"{self.name}_{self.through}"
            kept.mkdir(parents=True, exist_ok=True)
            for path in files:
                if pathlib.Path(path).is_file():
                    shutil.copy(path, kept)

    def is_over(self):
        """Whether the time for this kind is spent."""
        return time.monotonic() > self.end

    def row(self):
        codes = ", ".join(f"{code}: {count}" for code, count in sorted(self.codes.items()))
        return f"| {self.name} | {self.inputs} | {self.runs} | {self.through} | {codes} |"


def _shown(command):
    return " ".join(repr(argument) if len(argument) < 200 else f"{argument[:80]!r}..." for argument in command[1:])
