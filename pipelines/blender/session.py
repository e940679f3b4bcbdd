"""The Blender process behind a renderer: started once, told one job after another."""

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
    """The words that start Blender: --blender PATH, else $BLENDER, else on the PATH. `bpy` stands for the module of this
    Python."""
    named = given or os.environ.get("BLENDER") or "blender"
    if named == "bpy":
        return [sys.executable, "-B", SCRIPT]
    program = shutil.which(named)
    if not program:
        raise DriverError(ExitCode.MISSING, f"{named}: no such program (--blender PATH, or --bpy for the module)")
    return [program, "-b", "-Y", "--factory-startup", "--python-exit-code", "7", "-P", SCRIPT]


class BlenderSession:
    """One Blender process. A job that takes over `timeout` seconds, or a Blender that dies, ends the process group and
    raises DriverError(RENDERER); the next job starts a new one."""

    def __init__(self, blender=None, timeout=3600.0):
        self.command = find_blender(blender)
        self.timeout = timeout
        self.child, self.listener = None, None
        self.lock, self.halted = threading.Lock(), False
        # Raw renders go to a folder with a name that Blender's output path takes literally (no '#', no '{').
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

    def ask(self, job, **arguments):
        """Sends one job (a method of inside/session.py) and waits for its answer."""
        child, answers = self._process()
        try:
            child.stdin.write(json.dumps({"do": job, **arguments}) + "\n")
            child.stdin.flush()
            answer = answers.get(timeout=self.timeout)
        except queue.Empty:
            self.stop()
            raise DriverError(ExitCode.RENDERER, f"Blender did not answer within {self.timeout:g} s ({job})") from None
        except (BrokenPipeError, ValueError):  # it died, or was stopped and its pipe closed
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
        """One pass; returns (path of the raw EXR, seconds inside Blender). A file that was not written anew is an error."""
        raw = self.folder / "raw.exr"
        raw.unlink(missing_ok=True)
        answer = self.ask("render", target=str(raw), **arguments)
        if not raw.exists():
            raise DriverError(ExitCode.RENDERER, "Blender rendered, but wrote no file")
        return raw, answer["seconds"]

    def _process(self):
        """The child, started where none runs, and the queue of its answers."""
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
        """Stops, and no thread can start Blender anew while this lasts."""
        self.stop(halted=True)
        try:
            yield
        finally:
            self.halted = False

    def stop(self, halted=False):
        """From any thread; one that waits for an answer gets none and fails."""
        with self.lock:
            child, self.child = self.child, None
            self.halted = self.halted or halted
            listener = self.listener
        if child:
            process.stop(child)
            listener.join()
            with contextlib.suppress(BrokenPipeError):  # a job that was not sent yet
                child.stdin.close()
            child.stdout.close()
