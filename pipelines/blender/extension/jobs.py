"""One job at a time, beside Blender: commands run one after the other, read by a thread, looked at by a timer. Blender's
window never waits for them."""

import collections
import json
import os
import queue
import signal
import subprocess
import threading
import time

from . import programs

GRACE_SECONDS = 15  # from asking to killing: the loop has children of its own to stop
KEPT_LINES = 200

current = None  # the job that runs, or the last one


class Job:
    """Commands to run in a row. `title` and `results` (name -> path) are for who shows it."""

    def __init__(self, title, commands, results):
        self.title, self.results = title, results
        self.state = "running"  # then: done, failed, cancelled
        self.stage, self.fraction = "starting", 0.0
        self.problem = ""
        self.lines = collections.deque(maxlen=KEPT_LINES)
        self.begin = time.monotonic()
        self._commands = collections.deque(commands)
        self._heard = queue.SimpleQueue()
        self._child = self._asked = None
        self._next()

    @property
    def running(self):
        return self.state == "running"

    @property
    def seconds(self):
        return time.monotonic() - self.begin

    def poll(self):
        """Takes in what the commands said, goes on to the next one; returns whether the job still runs. Never waits."""
        if not self.running:
            return False
        self._listen()
        code = self._child.poll()
        if code is None:
            if self._asked and time.monotonic() - self._asked > GRACE_SECONDS:
                self._signal(kill=True)
            return True
        self._reader.join(1)  # the pipe is closed: the thread is at its end
        self._listen()
        if self._asked:
            self._finish("cancelled")
        elif code != 0:
            self.problem = self.lines[-1] if self.lines else f"ended with code {code}"
            self._finish("failed")
        elif self._commands:
            self._next()
        else:
            self.fraction = 1.0
            self._finish("done")
        return self.running

    def cancel(self):
        """Asks the command to stop; it is killed when it does not within GRACE_SECONDS."""
        if self.running and not self._asked:
            self._asked, self.stage = time.monotonic(), "stopping"
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
                env=programs.environment(),
                **group,
            )
        except OSError as error:
            self.problem = f"{words[0]}: {error.strerror}"
            self._finish("failed")
            return
        self._reader = threading.Thread(target=self._read, args=(self._child.stdout,), daemon=True)
        self._reader.start()

    def _read(self, pipe):
        with pipe:
            for line in pipe:
                self._heard.put(line.rstrip())

    def _listen(self):
        while True:
            try:
                line = self._heard.get_nowait()
            except queue.Empty:
                return
            if not self._take_progress(line) and line:
                self.lines.append(line)

    def _take_progress(self, line):
        """A line of --progress json, of the program ("done" of "total") or of the loop ("done": a share, and more); False
        for any other line."""
        if not line.startswith("{"):
            return False
        try:
            told = json.loads(line)
        except ValueError:
            return False
        if not self._asked and "stage" in told:
            self.stage = ", ".join([str(told["stage"]), *_figures(told)])
            self.fraction = min(max(told.get("done", 0) / (told.get("total") or 1), 0.0), 1.0)
        return True

    def _signal(self, kill=False):
        try:
            if os.name == "posix":
                os.killpg(self._child.pid, signal.SIGKILL if kill else signal.SIGTERM)
            elif kill:
                self._child.kill()
            else:
                self._child.send_signal(signal.CTRL_BREAK_EVENT)
        except ProcessLookupError:
            pass

    def _finish(self, state):
        self.state = state
        self.stage = state


def _figures(told):
    """What the loop knows of its result so far, in words."""
    known = (("samples", "{:.3g} spp"), ("error", "error {:.2g}"), ("seconds_left", "{:.0f} s left"))
    return [words.format(told[name]) for name, words in known if name in told]


def start(title, commands, results):
    """Starts a job and the timer that looks after it; returns the job."""
    global current
    import bpy

    if current and current.running:
        raise programs.Problem(f"{current.title} is still running")
    current = Job(title, commands, results)
    if not bpy.app.timers.is_registered(_tick):
        bpy.app.timers.register(_tick, first_interval=0.1, persistent=True)
    return current


def end():
    """For when the add-on goes: what runs is asked to stop, and killed if it does not."""
    if not current or not current.running:
        return
    current.cancel()
    while current.poll():
        time.sleep(0.05)


def _tick():
    import bpy

    running = current.poll()
    for window in bpy.context.window_manager.windows:
        for area in window.screen.areas:
            if area.type == "PROPERTIES":
                area.tag_redraw()
    return 0.25 if running else None
