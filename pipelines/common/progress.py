"""The progress of a driver: one bar for the whole run on a terminal, a line now and then in a log, or JSON objects on
standard error, one a line."""

import json
import sys
import time

from .terminal import print_lines

STYLES = ("auto", "bar", "json", "none")
LOG_SECONDS = 60  # Least time between two lines of a log
MIN_SHARE = 0.02  # Share of the run before which the remaining time is unknown


class Progress:
    """Shows the progress of `frames` frames in one of STYLES. 'auto' is 'bar' on a terminal, and elsewhere a line at
    most once a minute.

    together: whether the frames take turns, so that the figure `done` is that of all."""

    def __init__(self, style="auto", frames=1, together=False):
        self.style = ("bar" if sys.stderr.isatty() else "log") if style == "auto" else style
        self.frames, self.together, self.frame_index = frames, together, -1
        self.bar = None
        self.begin = self.last_line = time.monotonic()

    def __enter__(self):
        if self.style == "bar":
            from rich.console import Console
            from rich.progress import BarColumn, TextColumn
            from rich.progress import Progress as Bar

            columns = (
                TextColumn("{task.description}", markup=False),
                BarColumn(),
                TextColumn("{task.percentage:3.0f} %  {task.fields[left]}", markup=False),
            )
            # Lines on standard output appear above the bar, and go on to a file if that is where they are sent.
            self.bar = Bar(*columns, console=Console(stderr=True), transient=True, redirect_stdout=sys.stdout.isatty())
            self.bar.start()
            self.task = self.bar.add_task("", total=1.0, left="")
        return self

    def __exit__(self, *_):
        if self.bar:
            self.bar.stop()

    def begin_frame(self):
        """Called before each frame."""
        self.frame_index += 1

    def update(self, phase, **figures):
        """phase: what is being done. figures: frame, round, samples, error, seconds, seconds_left, done (0..1, of this
        frame); None where unknown."""
        figures = {key: value for key, value in figures.items() if value is not None}
        if self.style == "json":
            print(json.dumps({"event": "progress", "phase": phase, **figures}), file=sys.stderr, flush=True)
        elif self.style in ("bar", "log"):
            self._show(phase, figures)

    def _show(self, phase, figures):
        now = time.monotonic()
        done = min(figures.get("done", 0.0), 1.0)
        if not self.together:
            done = (max(self.frame_index, 0) + done) / self.frames
        left = (now - self.begin) * (1 - done) / done if done >= MIN_SHARE else None
        text = self._text(phase, figures)
        if self.bar:
            self.bar.update(self.task, description=text, completed=done, left=_duration(left))
        elif now - self.last_line >= LOG_SECONDS:
            self.last_line = now
            words = [text, f"{100 * done:.0f} %", _duration(left)]
            print_lines(", ".join(filter(None, words)), file=sys.stderr)

    def _text(self, phase, figures):
        known = []
        if self.frames > 1:
            number = f"frame {figures.get('frame', '')}"
            known.append(number if self.together else f"{number} ({self.frame_index + 1} of {self.frames})")
        known.append(phase)
        known += [f"{figures['samples']:.3g} spp"] if "samples" in figures else []
        known += [f"relMSE {figures['error']:.3g}"] if "error" in figures else []
        return ", ".join(known)


def _duration(seconds):
    """Seconds that are left, to read; '' where unknown."""
    if seconds is None:
        return ""
    minutes, seconds = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours}:{minutes:02}:{seconds:02} left" if hours else f"{minutes}:{seconds:02} left"
