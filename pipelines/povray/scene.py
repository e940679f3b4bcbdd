"""One POV-Ray scene as it is rendered here: the user's file and options, never changed, and POV-Ray on it.

Every render has a wrapper of ours as its input, which #includes the user's scene and adds lines of its own at the end. What
POV-Ray cannot take on a command line or in a string (quotes, a leading '-', spaces) never reaches it: it runs in the
scene's folder and is given names in a work folder of ours, where the scene is a symbolic link.
"""

import dataclasses
import os
import pathlib
import re
import shutil
import subprocess
import tempfile
import time
from typing import Optional

import numpy as np
import OpenImageIO as oiio

from ..common import process
from ..common.errors import DriverError, ExitCode
from .crops import Crop

# POV-Ray's own configuration (/etc/povray/3.7/povray.conf) lets it write there.
WORK_PARENT = pathlib.Path("/tmp")
WORK_PREFIX = "polyrecon-povray-"
# Last word on the command line, after the user's: linear EXR without alpha, one ray a (sub)pixel, no window, no waiting, no old file.
FORCED = ("+FE", "-UA", "-A", "-D", "-P", "-C", "Fatal_Console=on", "Render_Console=on")


AT_ONCE = 4  # POV-Rays side by side,
SMALL = 1 << 22  # unless their images have more subpixels than this (memory)


@dataclasses.dataclass(frozen=True)
class Shot:
    """One render: scale x scale subpixels of each pixel of the crop, or of the whole frame; `tail` is scene text to add,
    `size` another (width, height) than the frame's."""

    scale: int = 1
    tail: str = ""
    options: tuple = ()
    crop: Optional[Crop] = None
    size: Optional[tuple] = None

    def words(self, scene):
        width, height = self.size or (scene.width, scene.height)
        words = [f"+W{self.scale * width}", f"+H{self.scale * height}"]
        if self.crop:
            words += [f"+SC{self.scale * self.crop.x0 + 1}", f"+EC{self.scale * self.crop.x1}"]
            words += [f"+SR{self.scale * self.crop.y0 + 1}", f"+ER{self.scale * self.crop.y1}"]
        return words

    def subpixels(self, scene):
        width, height = self.size or (scene.width, scene.height)
        return self.scale**2 * width * height


@dataclasses.dataclass(frozen=True)
class _AsAsked(Shot):
    """The first pixel, at the size that the user's options say."""

    crop: Crop = Crop(0, 0, 1, 1)

    def words(self, scene):
        return ["+SC1", "+EC1", "+SR1", "+ER1"]


@dataclasses.dataclass
class _Run:
    folder: pathlib.Path
    child: subprocess.Popen


class Scene:
    """A scene file with the options that it is to be rendered with. Use it in a `with`: the work folder goes with it."""

    def __init__(self, path, options=(), povray="povray", timeout=None):
        self.path = pathlib.Path(path).absolute()
        if not self.path.is_file():
            raise DriverError(ExitCode.MISSING, f"{path}: no such scene")
        self.program = shutil.which(povray)
        if not self.program:
            raise DriverError(ExitCode.MISSING, f"{povray}: no such program (Debian: apt-get install povray; --povray)")
        self.timeout = timeout
        self.messages = ""  # what POV-Ray wrote in its last run
        _remove_stale_work()
        self.work = pathlib.Path(tempfile.mkdtemp(prefix=f"{WORK_PREFIX}{os.getpid()}-", dir=WORK_PARENT))
        try:
            (self.work / "scene.pov").symlink_to(self.path)
            self.options = self._safe_options(options)
            begun = time.monotonic()
            self.width, self.height = self._resolution()
            self.parse_seconds = time.monotonic() - begun  # what every render costs before its first pixel
        except BaseException:
            self.close()
            raise

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    def close(self):
        shutil.rmtree(self.work, ignore_errors=True)

    def render(self, scale=1, tail="", options=(), crop=None, size=None):
        """One render: see Shot."""
        return self.render_all([Shot(scale, tail, options, crop, size)])[0]

    def render_all(self, shots):
        """Images of several shots: radiance (linear), float32 (scale * height, scale * width, 3), of the crop or the whole.
        A POV-Ray that starts and ends sleeps over half a second, so some run side by side."""
        at_once = AT_ONCE if sum(shot.subpixels(self) for shot in shots) < len(shots) * SMALL else 1
        images, running = [None] * len(shots), {}
        try:
            for number, shot in enumerate(shots):
                if len(running) == at_once:
                    first = next(iter(running))
                    images[first] = self._image(shots[first], running.pop(first))
                running[number] = self._start(number, shot)
            while running:
                first = next(iter(running))
                images[first] = self._image(shots[first], running.pop(first))
        finally:
            for run in running.values():
                process.stop(run.child)
        return images

    def debug(self, tail, marker):
        """What `tail` printed by #debug on lines that begin with `marker`, from a render of one pixel; [] where POV-Ray
        did not take the tail."""
        try:
            self.render(1, tail, ("Debug_Console=on",), Crop(0, 0, 1, 1))
        except DriverError:
            return []
        return [line[len(marker) :].strip() for line in self.messages.splitlines() if line.startswith(marker)]

    def _start(self, number, shot):
        """Starts POV-Ray on a shot, in a folder of its own: it names its output as it likes, and its messages go to a
        file."""
        folder = self.work / f"run{number}"
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir()
        wrapper = folder / "wrapper.pov"
        wrapper.write_text(f'#include "{self.work}/scene.pov"\n{shot.tail}\n')
        words = [self.program, f"+L{self.work}/caller", *self.options, *FORCED, *shot.options, *shot.words(self)]
        words += [f"+I{wrapper}", f"+O{folder}/render.exr"]
        with (folder / "messages").open("wb") as messages:
            return _Run(folder, process.start(words, cwd=self.path.parent, stdout=messages, stderr=messages))

    def _image(self, shot, run):
        """Waits for a run and reads its image."""
        try:
            code = run.child.wait(self.timeout)
        except subprocess.TimeoutExpired:
            process.stop(run.child)
            text = f"{self.path}: POV-Ray took over {self.timeout:g} s (--timeout)"
            raise DriverError(ExitCode.RENDERER, text) from None
        except BaseException:
            process.stop(run.child)
            raise
        self.messages = (run.folder / "messages").read_text(errors="replace")
        if code != 0:
            raise DriverError(ExitCode.RENDERER, f"{self.path}: POV-Ray ended with code {code}: {self._why()}")
        image = _read_rgb(self._only_output(run.folder), shot.scale, shot.crop or self._whole(shot))
        shutil.rmtree(run.folder)
        return image

    def _whole(self, shot):
        return Crop(0, 0, *(shot.size or (self.width, self.height)))

    def _only_output(self, folder):
        """The one file that was written: POV-Ray puts the frame's number into the name where there is an animation."""
        files = sorted(folder.glob("render*.exr"))
        if not files:
            raise DriverError(ExitCode.RENDERER, f"{self.path}: POV-Ray wrote no image")
        if len(files) > 1:
            raise DriverError(
                ExitCode.USAGE, f"{self.path}: the options ask for {len(files)} frames: choose one by +SFn +EFn"
            )
        return files[0]

    def _why(self):
        """The first error that POV-Ray printed, on one line; it wraps its messages at 80 columns."""
        unwrapped = re.sub(r"\n +(?=\S)", " ", self.messages)
        lines = [
            line.strip() for line in unwrapped.splitlines() if re.search(r"\b(?:[Ee]rror|[Pp]roblem|[Ff]ailed)\b", line)
        ]
        text = " ".join(lines[:2]) or (self.messages.strip().splitlines() or ["it said nothing"])[-1]
        return text.replace(f"{self.work}/scene.pov", self.path.name)

    def _safe_options(self, options):
        """The user's options with paths that hold from the scene's folder: libraries (+L), .ini files and the caller's
        folder become links in the work folder."""
        (self.work / "caller").symlink_to(pathlib.Path.cwd())
        return [self._safe_option(word, number) for number, word in enumerate(options)]

    def _safe_option(self, word, number):
        library = re.match(r"(?i)([+-]L|Library_Path=)(.+)$", word, re.DOTALL)
        if library:
            return library[1] + self._link(library[2].strip('"'), f"library{number}")
        ini = re.match(r"(?is)([^+\-=][^=]*?)(\[[^\]]*\])?$", word)  # name.ini or name.ini[section]
        if ini and pathlib.Path(ini[1]).is_file():
            return self._link(ini[1], f"options{number}.ini") + (ini[2] or "")
        if not word.startswith(("+", "-")) and "=" not in word:
            raise DriverError(ExitCode.MISSING, f"{word}: no such .ini file (what follows -- are POV-Ray's options)")
        return word

    def _link(self, path, name):
        (self.work / name).symlink_to(pathlib.Path(path).absolute())
        return str(self.work / name)

    def _resolution(self):
        """Width and height that the options ask for, as POV-Ray itself understood them. This render of one pixel also
        tells whether the scene can be parsed at all."""
        run = self._start(0, _AsAsked())
        self._image(_AsAsked(), run)
        version = re.search(r"POV-Ray (\d\S*)", self.messages) or re.search(r"Ray Tracer Version (\S+)", self.messages)
        self.version = f"POV-Ray {version[1]}" if version else "POV-Ray"
        found = re.search(r"Image resolution\W+(\d+) by (\d+)", self.messages)
        if not found:
            raise DriverError(ExitCode.RENDERER, f"{self.path}: POV-Ray did not say the image's size")
        return int(found[1]), int(found[2])


def _remove_stale_work():
    """Work folders of this user whose driver was killed outright."""
    for folder in WORK_PARENT.glob(f"{WORK_PREFIX}*-*"):
        process_number = folder.name[len(WORK_PREFIX) :].partition("-")[0]
        try:
            if folder.stat().st_uid == os.getuid():
                os.kill(int(process_number), 0)
        except ProcessLookupError:
            shutil.rmtree(folder, ignore_errors=True)
        except (OSError, ValueError):
            continue


def _read_rgb(path, scale, crop):
    """The crop out of a file of the whole frame: POV-Ray leaves the rest empty."""
    file = oiio.ImageInput.open(os.fspath(path))
    if not file:
        raise DriverError(ExitCode.RENDERER, f"{path}: {oiio.geterror()}")
    try:
        y0, y1 = scale * crop.y0, scale * crop.y1
        pixels = file.read_scanlines(0, 0, y0, y1, 0, 0, 3, "float")
        if pixels is None:
            raise DriverError(ExitCode.RENDERER, f"{path}: {file.geterror()}")
        pixels = np.asarray(pixels, np.float32).reshape(y1 - y0, file.spec().width, 3)
        return np.ascontiguousarray(pixels[:, scale * crop.x0 : scale * crop.x1])
    finally:
        file.close()
