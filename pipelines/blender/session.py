"""The Blender process of a renderer. It starts once and does one job after another."""

import collections
import contextlib
import json
import os
import pathlib
import queue
import shutil
import subprocess
import sys
import tempfile
import threading

from ..common import confine, modules, process
from ..common.errors import DriverError, ExitCode
from ..common.work_folder import WorkFolder

SCRIPT = pathlib.Path(__file__).resolve().parent / "inside" / "session.py"
MARK = b"@polyrecon "
LONGEST_LOG_LINE = 1 << 16
LOG_LINES_KEPT = 40


def find_blender(given=None):
    """The command that starts Blender. `given` is the value of --blender; without it, $BLENDER and the PATH are tried.
    `bpy` stands for the module of this Python."""
    named = given or os.environ.get("BLENDER") or "blender"
    if named == "bpy":
        if not modules.is_there("bpy"):
            raise DriverError(ExitCode.MISSING, modules.advice(["bpy"]))
        return [sys.executable, "-B", SCRIPT]
    program = shutil.which(named)
    if not program:
        raise DriverError(ExitCode.MISSING, f"{named}: no such program: give --blender PATH, or --bpy for the module")
    return [program, "-b", "-Y", "--factory-startup", "--python-exit-code", "7", "-P", SCRIPT]


class BlenderSession:
    """A Blender process.

    If a job takes over `timeout` seconds or Blender dies, the process group is ended and DriverError(RENDERER) is
    raised. The next job starts a new process."""

    def __init__(self, blender=None, timeout=3600.0):
        self.command = find_blender(blender)
        self.timeout = timeout
        self.child, self.listeners = None, []
        self.lock, self.halted = threading.Lock(), False
        # Blender replaces '#' and '{' in an output path; this folder's name has neither.
        self._work = WorkFolder("blender")
        self.folder = self._work.path
        self.not_confined = confine.why_not(self.command[0])

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    def close(self):
        self.stop()
        self._work.close()

    @property
    def running(self):
        return self.child is not None

    def request(self, job, **arguments):
        """Sends one job (a method of inside/session.py) and waits for its answer."""
        child, answers = self._process()
        try:
            child.stdin.write(json.dumps({"do": job, **arguments}).encode() + b"\n")
            child.stdin.flush()
            answer = answers.get(timeout=self.timeout)
        except queue.Empty:
            self.stop()
            raise DriverError(ExitCode.RENDERER, f"Blender did not answer within {self.timeout:g} s ({job})") from None
        except (BrokenPipeError, ValueError):  # Blender died, or was stopped.
            answer = None
        except BaseException:
            self.stop()
            raise
        if answer is None:
            with contextlib.suppress(subprocess.TimeoutExpired):  # It may live on with a broken pipe.
                child.wait(process.GRACE_SECONDS)
            self.stop()
            code = child.returncode
            last = next((line for line in reversed(self.log) if line.strip()), "no message")
            raise DriverError(ExitCode.RENDERER, f"Blender ended with code {code} ({job}): {last}")
        if "error" in answer:
            raise DriverError(ExitCode.RENDERER, f"Blender: {answer['error']}")
        return answer

    def new_folder(self):
        """An empty folder that Blender can write into, until the session is closed."""
        return tempfile.mkdtemp(dir=self.folder)

    def render(self, **arguments):
        """Renders a pass; returns (path of the raw EXR, seconds inside Blender)."""
        raw = self.folder / "raw.exr"
        raw.unlink(missing_ok=True)
        answer = self.request("render", target=str(raw), **arguments)
        if not raw.exists():
            raise DriverError(ExitCode.RENDERER, "Blender rendered but wrote no file")
        return raw, answer["seconds"]

    def _process(self):
        """The child process and the queue of its answers. A process is started if none runs."""
        with self.lock:
            if self.halted:
                raise DriverError(ExitCode.RENDERER, "Blender was stopped")
            if not self.running:
                self._start()
            return self.child, self.answers

    def _start(self):
        self.log = collections.deque(maxlen=LOG_LINES_KEPT)
        self.answers = queue.Queue()
        words = self.command if self.not_confined else confine.confined(self.command, [self.folder])
        self.child = process.start(
            words,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            env={**os.environ, **dict.fromkeys(("TMPDIR", "TEMP", "TMP"), os.fspath(self.folder))},
        )
        self.listeners = [
            threading.Thread(target=listen, args=(self.child, *more), daemon=True)
            for listen, more in ((self._listen, (self.answers,)), (self._keep_log, ()))
        ]
        for listener in self.listeners:
            listener.start()

    def _listen(self, child, answers):
        """Puts the session's answers into the queue, and None at their end. Standard output carries nothing else: what
        Blender prints while it has a file open goes to standard error."""
        try:
            for line in child.stdout:
                if line.startswith(MARK):
                    answer = json.loads(line[len(MARK) :])
                    if not isinstance(answer, dict):
                        raise ValueError("is not an object")
                    answers.put(answer)
        except (ValueError, RecursionError) as error:
            self.log.append(f"an answer that cannot be read: {error}")
        finally:
            answers.put(None)

    def _keep_log(self, child):
        while line := child.stderr.readline(LONGEST_LOG_LINE):
            self.log.append(process.decoded(line).rstrip())

    @contextlib.contextmanager
    def halt(self):
        """A context in which Blender is stopped and no thread can start it."""
        self.stop(halted=True)
        try:
            yield
        finally:
            self.halted = False

    def stop(self, halted=False):
        """Ends Blender. Any thread may call this; a thread that waits for an answer then raises an error."""
        with self.lock:
            child, self.child = self.child, None
            self.halted = self.halted or halted
            listeners = self.listeners
        if child:
            process.stop(child)
            for listener in listeners:
                listener.join()
            with contextlib.suppress(BrokenPipeError):  # A job may not be sent yet.
                child.stdin.close()
            child.stdout.close()
            child.stderr.close()
