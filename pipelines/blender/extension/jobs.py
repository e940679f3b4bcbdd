"""Runs one job at a time in the background of Blender.

A job is a list of commands that run one after another. A thread reads their output and a timer polls them, so Blender's
window never waits."""

import collections
import contextlib
import json
import os
import queue
import signal
import subprocess
import threading
import time

from . import programs

GRACE_SECONDS = 15  # between SIGTERM and SIGKILL; the adaptive loop ends its child processes meanwhile
MAX_LINES = 200

current = None  # the running job, or else the last one


class Job:
    """Commands that run one after another. `title` and `results` ({name: path}) are shown in the panel, and so is what
    the program's report (a JSON file) advises. `environment`: of the commands."""

    def __init__(self, title, commands, results, report=None, environment=None):
        self.title, self.results, self._report = title, results, report
        self._environment = environment
        self.advice = []  # [(what is missing, what to do)]
        self.state = "running"  # later "done", "failed" or "cancelled"
        self.phase, self.fraction = "starting", 0.0
        self.error = ""
        self.lines = collections.deque(maxlen=MAX_LINES)
        self.begin = time.monotonic()
        self._commands = collections.deque(commands)
        self._output = queue.SimpleQueue()
        self._child = self._cancelled_at = None
        self._next()

    @property
    def running(self):
        return self.state == "running"

    @property
    def seconds(self):
        return time.monotonic() - self.begin

    def poll(self):
        """Reads output, starts the next command if one has ended; returns whether the job runs. It never waits."""
        if not self.running:
            return False
        self._listen()
        code = self._child.poll()
        if code is None:
            if self._cancelled_at and time.monotonic() - self._cancelled_at > GRACE_SECONDS:
                self._signal(kill=True)
            return True
        self._reader.join(1)  # The pipe is closed, so the thread ends.
        self._listen()
        if self._cancelled_at:
            self._finish("cancelled")
        elif code != 0:
            self.error = self.lines[-1] if self.lines else f"ended with code {code}"
            self._finish("failed")
        elif self._commands:
            self._next()
        else:
            self.fraction = 1.0
            self.advice = _advice_of(self._report)
            self._finish("done")
        return self.running

    def cancel(self):
        """Asks the command to stop. It is killed if it does not within GRACE_SECONDS."""
        if self.running and not self._cancelled_at:
            self._cancelled_at, self.phase = time.monotonic(), "stopping"
            self._commands.clear()
            self._signal()

    def _next(self):
        words = self._commands.popleft()
        group = (
            {"start_new_session": True}
            if os.name == "posix"
            else {"creationflags": subprocess.CREATE_NEW_PROCESS_GROUP}
        )
        try:
            self._child = subprocess.Popen(
                [os.fspath(word) for word in words],
                stdin=subprocess.DEVNULL,
                stdout=subprocess.PIPE,
                stderr=subprocess.STDOUT,
                text=True,
                errors="replace",
                env=self._environment,
                **group,
            )
        except OSError as error:
            self.error = f"{words[0]}: {error.strerror}"
            self._finish("failed")
            return
        self._reader = threading.Thread(target=self._read, args=(self._child.stdout,), daemon=True)
        self._reader.start()

    def _read(self, pipe):
        with pipe:
            for line in pipe:
                self._output.put(line.rstrip())

    def _listen(self):
        while True:
            try:
                line = self._output.get_nowait()
            except queue.Empty:
                return
            if not self._take_progress(line) and line:
                self.lines.append(line)

    def _take_progress(self, line):
        """Reads a line of --progress json; returns False for any other line.

        The program writes "done" and "total"; the loop writes "done" as a share, and further figures."""
        if not line.startswith("{"):
            return False
        try:
            progress = json.loads(line)
        except ValueError:
            return False
        if not self._cancelled_at and "phase" in progress:
            self.phase = ", ".join([str(progress["phase"]), *_figures(progress)])
            self.fraction = min(max(progress.get("done", 0) / (progress.get("total") or 1), 0.0), 1.0)
        return True

    def _signal(self, kill=False):
        with contextlib.suppress(ProcessLookupError):
            if os.name == "posix":
                os.killpg(self._child.pid, signal.SIGKILL if kill else signal.SIGTERM)
            elif kill:
                self._child.kill()
            else:
                self._child.send_signal(signal.CTRL_BREAK_EVENT)

    def _finish(self, state):
        self.state = state
        self.phase = state


def _advice_of(report):
    """The advice of a report about missing passes; passes that are switched on at one place stand together."""
    if report is None:
        return []
    with open(report, encoding="utf-8") as file:
        advice = json.load(file).get("advice", [])
    places = {}
    for one in advice:
        is_pass = one["pass"] not in ("prior", "aov")
        places.setdefault(one["how"], []).append(f"no {one['pass']} ({one['without']})" if is_pass else one["without"])
    return [(", ".join(missing), how) for how, missing in places.items()]


def _figures(progress):
    """The figures of the loop's progress as texts."""
    known = (("samples", "{:.3g} spp"), ("error", "error {:.2g}"), ("seconds_left", "{:.0f} s left"))
    return [text.format(progress[name]) for name, text in known if name in progress]


def start(title, commands, results, report=None, environment=None):
    """Starts a job and the timer that polls it; returns the job."""
    global current
    import bpy

    if current and current.running:
        raise programs.SetupError(f"{current.title} is still running")
    current = Job(title, commands, results, report, environment)
    if not bpy.app.timers.is_registered(_tick):
        bpy.app.timers.register(_tick, first_interval=0.1, persistent=True)
    return current


def end():
    """Ends the running job, when the add-on is disabled."""
    if not current or not current.running:
        return
    current.cancel()
    while current.poll():
        time.sleep(0.05)


def _tick():
    import bpy

    from . import operators

    running = current.poll()
    if not running:
        operators.show_result(current)
    for window in bpy.context.window_manager.windows:
        for area in window.screen.areas:
            if area.type == "PROPERTIES":
                area.tag_redraw()
    return 0.25 if running else None
