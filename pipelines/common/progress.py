"""The progress of a driver: a bar on a terminal, or JSON objects on standard error, one a line."""

import json
import sys

STYLES = ("auto", "bar", "json", "none")


class Progress:
    """Shows the progress in one of STYLES. 'auto' is 'bar' on a terminal and 'none' elsewhere."""

    def __init__(self, style="auto"):
        self.style = ("bar" if sys.stderr.isatty() else "none") if style == "auto" else style
        self.bar = None

    def __enter__(self):
        if self.style == "bar":
            from rich.console import Console
            from rich.progress import BarColumn, TextColumn, TimeElapsedColumn
            from rich.progress import Progress as Bar

            columns = (
                TextColumn("{task.description}", markup=False),
                BarColumn(),
                TextColumn("{task.percentage:3.0f} %"),
                TimeElapsedColumn(),
            )
            self.bar = Bar(*columns, console=Console(stderr=True), transient=True)
            self.bar.start()
            self.task = self.bar.add_task("", total=1.0)
        return self

    def __exit__(self, *_):
        if self.bar:
            self.bar.stop()

    def update(self, phase, **figures):
        """phase: what is being done. figures: frame, round, samples, error, seconds, seconds_left, done (0..1); None
        where unknown."""
        figures = {key: value for key, value in figures.items() if value is not None}
        if self.style == "json":
            print(json.dumps({"event": "progress", "phase": phase, **figures}), file=sys.stderr, flush=True)
        elif self.bar:
            known = [f"{figures['samples']:.3g} spp"] if "samples" in figures else []
            known += [f"relMSE {figures['error']:.3g}"] if "error" in figures else []
            known += [f"{figures['seconds_left']:.0f} s left"] if "seconds_left" in figures else []
            self.bar.update(self.task, description=", ".join([phase, *known]), completed=figures.get("done", 0.0))
