"""A POV-Ray scene: the user's file and options, and the runs of POV-Ray on it.

The input of every run is a wrapper file, which #includes the user's scene and adds lines at its end. POV-Ray gets names
in a work folder, in which the scene is a symbolic link. So it never meets a name that it cannot read on a command line
or in a string (quotes, a leading '-', spaces). It runs in a folder of links to the files of the scene's folder, and can
write nowhere but in the work folder: a scene chooses what it writes, too."""

import dataclasses
import os
import pathlib
import re
import shutil
import subprocess
import time
from typing import Optional

import numpy as np

from ..common import confine, exr, process
from ..common.errors import DriverError, ExitCode
from ..common.work_folder import WorkFolder
from .crops import Crop

# POV-Ray's default configuration (/etc/povray/3.7/povray.conf) allows it to write there.
WORK_PARENT = pathlib.Path("/tmp")
# Options after the user's, which overrule them: linear EXR without alpha, one ray a (sub)pixel, no window, no waiting,
# no continuing of an older file.
FORCED = ("+FE", "-UA", "-A", "-D", "-P", "-C", "Fatal_Console=on", "Render_Console=on")
# So many POV-Rays run concurrently if their images have fewer subpixels than this on average; memory is the limit.
CONCURRENT_RUNS, SMALL_IMAGE = 4, 1 << 22
ONE_PIXEL = Crop(0, 0, 1, 1)


@dataclasses.dataclass(frozen=True)
class Shot:
    """A render of a scene."""

    scale: int = 1  # scale x scale subpixels of each pixel
    tail: str = ""  # scene text that is added at the end
    options: tuple = ()  # further options of POV-Ray
    crop: Optional[Crop] = None  # None: the whole frame
    size: Optional[tuple] = None  # (width, height); None: the frame's

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
class _FirstPixel(Shot):
    """The first pixel of a frame whose size is not known yet: that of the user's options."""

    crop: Crop = ONE_PIXEL

    def words(self, scene):
        return ["+SC1", "+EC1", "+SR1", "+ER1"]


@dataclasses.dataclass
class _Run:
    folder: pathlib.Path
    child: subprocess.Popen


class Scene:
    """A scene file with the user's options. It is a context manager, which removes the work folder at its end."""

    def __init__(self, path, options=(), povray="povray", timeout=None):
        self.path = pathlib.Path(path).absolute()
        if not self.path.is_file():
            raise DriverError(ExitCode.MISSING, f"{path}: no such scene")
        self.program = shutil.which(povray)
        if not self.program:
            raise DriverError(
                ExitCode.MISSING, f"{povray}: no such program: install POV-Ray (Debian: povray) or give --povray PATH"
            )
        self.timeout = timeout
        self.messages = ""  # of POV-Ray in its last run
        self.not_confined = confine.why_not(self.program)
        self._work_folder = WorkFolder("povray", WORK_PARENT)
        self.work = self._work_folder.path
        try:
            (self.work / "scene.pov").symlink_to(self.path)
            self.options = self._safe_options(options)
            self.place = self.path.parent if self.not_confined else self._linked_place()
            begun = time.monotonic()
            self.width, self.height = self._resolution()
            self.parse_seconds = time.monotonic() - begun  # of every run, before its first pixel
        except BaseException:
            self.close()
            raise

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    def close(self):
        self._work_folder.close()

    def render(self, scale=1, tail="", options=(), crop=None, size=None):
        """Renders a Shot with these values; returns its image."""
        return self.render_all([Shot(scale, tail, options, crop, size)])[0]

    def render_all(self, shots):
        """Renders shots; returns their images: linear radiance, float32 (scale * height, scale * width, 3), of the crop
        or the frame. POV-Ray sleeps over half a second when it starts and ends, so several runs are concurrent."""
        concurrent = CONCURRENT_RUNS if sum(shot.subpixels(self) for shot in shots) < len(shots) * SMALL_IMAGE else 1
        images, running = [None] * len(shots), {}
        try:
            for number, shot in enumerate(shots):
                if len(running) == concurrent:
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
        """Renders one pixel with `tail`; returns the rest of the lines printed by #debug that begin with `marker`. It
        is [] if POV-Ray rejects the tail."""
        try:
            self.render(1, tail, ("Debug_Console=on",), ONE_PIXEL)
        except DriverError:
            return []
        return [line[len(marker) :].strip() for line in self.messages.splitlines() if line.startswith(marker)]

    def _start(self, number, shot):
        """Starts POV-Ray on a shot. The run has a folder, for its messages and its output, whose name POV-Ray
        chooses."""
        folder = self.work / f"run{number}"
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir()
        wrapper = folder / "wrapper.pov"
        wrapper.write_text(f'#include "{self.work}/scene.pov"\n{shot.tail}\n')
        words = [self.program, f"+L{self.work}/caller", *self.options, *FORCED, *shot.options, *shot.words(self)]
        words += [f"+I{wrapper}", f"+O{folder}/render.exr"]
        if not self.not_confined:
            words = confine.confined(words, [folder, self.place])
        with (folder / "messages").open("wb") as messages:
            environment = {**os.environ, "TMPDIR": str(folder)}
            child = process.start(words, cwd=self.place, stdout=messages, stderr=messages, env=environment)
            return _Run(folder, child)

    def _image(self, shot, run):
        """Waits for a run and reads its image."""
        try:
            code = run.child.wait(self.timeout)
        except subprocess.TimeoutExpired:
            process.stop(run.child)
            text = f"{self.path}: POV-Ray ran for more than {self.timeout:g} s (--pass-timeout)"
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
        """The file that the run wrote. In an animation POV-Ray adds the frame's number to its name."""
        files = sorted(folder.glob("render*.exr"))
        if not files:
            raise DriverError(ExitCode.RENDERER, f"{self.path}: POV-Ray wrote no image")
        if len(files) > 1:
            raise DriverError(
                ExitCode.USAGE, f"{self.path}: the options select {len(files)} frames: select one with +SFn +EFn"
            )
        return files[0]

    def _why(self):
        """The first error of POV-Ray's messages, which are wrapped at 80 columns, on one line."""
        unwrapped = re.sub(r"\n +(?=\S)", " ", self.messages)
        lines = [
            line.strip() for line in unwrapped.splitlines() if re.search(r"\b(?:[Ee]rror|[Pp]roblem|[Ff]ailed)\b", line)
        ]
        text = " ".join(lines[:2]) or (self.messages.strip().splitlines() or ["no message"])[-1]
        return text.replace(f"{self.work}/scene.pov", self.path.name)

    def _safe_options(self, options):
        """The user's options with paths that are valid in the scene's folder: libraries (+L), .ini files and the
        current folder become links in the work folder."""
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
            raise DriverError(
                ExitCode.MISSING, f"{word}: no such .ini file (the words after -- are options of POV-Ray)"
            )
        return word

    def _link(self, path, name):
        (self.work / name).symlink_to(pathlib.Path(path).absolute())
        return str(self.work / name)

    def _linked_place(self):
        """A folder of links to what is in the scene's folder. The scene finds its files there and may make others."""
        place = self.work / "place"
        place.mkdir()
        for entry in os.scandir(self.path.parent):
            (place / entry.name).symlink_to(entry.path)
        self.options.append(f"+L{self._link(self.path.parent, 'folder')}")  # For names that begin with ../
        return place

    def _resolution(self):
        """The width and height of the options, as POV-Ray reads them, from a render of one pixel. It fails if POV-Ray
        cannot parse the scene."""
        run = self._start(0, _FirstPixel())
        self._image(_FirstPixel(), run)
        version = re.search(r"POV-Ray (\d\S*)", self.messages) or re.search(r"Ray Tracer Version (\S+)", self.messages)
        self.version = f"POV-Ray {version[1]}" if version else "POV-Ray"
        found = re.search(r"Image resolution\W+(\d+) by (\d+)", self.messages)
        if not found:
            raise DriverError(ExitCode.RENDERER, f"{self.path}: POV-Ray did not print the size of the image")
        width, height = int(found[1]), int(found[2])
        if not width or not height:
            raise DriverError(ExitCode.USAGE, f"{self.path}: the options give a size of {width} x {height} pixels")
        return width, height


def _read_rgb(path, scale, crop):
    """The crop of a file of the whole frame. The file has no values outside of it."""
    with exr.opened(path) as file:
        y0, y1 = scale * crop.y0, scale * crop.y1
        pixels = file.read_scanlines(0, 0, y0, y1, 0, 0, 3, "float")
        if pixels is None:
            raise DriverError(ExitCode.RENDERER, f"{path}: {file.geterror()}")
        pixels = np.asarray(pixels, np.float32).reshape(y1 - y0, file.spec().width, 3)
        return np.ascontiguousarray(pixels[:, scale * crop.x0 : scale * crop.x1])
