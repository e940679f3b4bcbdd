"""The Blender process of a renderer. It starts once and does one job after another."""

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

from ..common import process
from ..common.errors import DriverError, ExitCode

SCRIPT = pathlib.Path(__file__).resolve().parent / "inside" / "session.py"
MARK = "@polyrecon "
LOG_LINES_KEPT = 40


def find_blender(given=None):
    """The command that starts Blender. `given` is the value of --blender; without it, $BLENDER and the PATH are tried.
    `bpy` stands for the module of this Python."""
    named = given or os.environ.get("BLENDER") or "blender"
    if named == "bpy":
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
        self.child, self.listener = None, None
        self.lock, self.halted = threading.Lock(), False
        # Blender replaces '#' and '{' in an output path; this folder's name has neither.
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="polyrecon-blender-"))

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    def close(self):
        self.stop()
        shutil.rmtree(self.folder, ignore_errors=True)

    @property
    def running(self):
        return self.child is not None

    def request(self, job, **arguments):
        """Sends one job (a method of inside/session.py) and waits for its answer."""
        child, answers = self._process()
        try:
            child.stdin.write(json.dumps({"do": job, **arguments}) + "\n")
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
            code = child.wait()
            self.stop()
            last = next((line for line in reversed(self.log) if line.strip()), "no message")
            raise DriverError(ExitCode.RENDERER, f"Blender ended with code {code} ({job}): {last}")
        if "error" in answer:
            raise DriverError(ExitCode.RENDERER, f"Blender: {answer['error']}")
        return answer

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
        self.log = []
        self.answers = queue.Queue()
        self.child = process.start(
            self.command,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            errors="replace",
        )
        self.listener = threading.Thread(target=self._listen, args=(self.child, self.answers), daemon=True)
        self.listener.start()

    def _listen(self, child, answers):
        for line in child.stdout:
            if line.startswith(MARK):
                answers.put(json.loads(line[len(MARK) :]))
            else:
                self.log = [*self.log[-LOG_LINES_KEPT:], line.rstrip()]
        answers.put(None)

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
            listener = self.listener
        if child:
            process.stop(child)
            listener.join()
            with contextlib.suppress(BrokenPipeError):  # A job may not be sent yet.
                child.stdin.close()
            child.stdout.close()
