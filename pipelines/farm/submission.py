"""What a submission consists of, for every engine: its tasks, with the memory and seconds of each."""

import dataclasses
import json
import os

from ..common.denoise_defaults import DEFAULT_FRAME_RADIUS, DEFAULT_QUALITY
from ..common.errors import DriverError, ExitCode
from ..common.frame_names import frame_path, parse_ranges
from ..common.polyrecon_cli import Polyrecon
from .requirements import MEMORY_MARGIN, Model, chunk_for, frame_of, threads_for

AOV_OPTIONS = ("-l", "--aov")


@dataclasses.dataclass(frozen=True)
class Submission:
    polyrecon: Polyrecon  # Has checked the options.
    frames: list
    chunk: int  # Frames of a task
    threads: int  # Of a task
    request: int  # Bytes that a task needs
    limit: int  # The program's --max-memory
    gpus: int

    @property
    def needs(self):
        """What a task needs, in words."""
        words = [counted(self.threads, "thread")]
        if self.gpus:
            words.append(counted(self.gpus, "graphics card"))
        if self.request:
            words.append(f"{self.request / 1e9:.2f} GB")
        return words[0] if len(words) == 1 else f"{', '.join(words[:-1])} and {words[-1]}"


def submission_of(options, nodes, max_tasks):
    """The Submission of what add_job_options reads. Raises DriverError where a task would fail.

    nodes, max_tasks: functions without arguments, asked when the options are checked: the kinds of Node, and the
    largest number of tasks."""
    frames = parse_ranges(options.frames)
    polyrecon = Polyrecon(options.polyrecon)
    check_options(polyrecon, options)
    frame = first_frame(options, frames, polyrecon)
    request = request_of(options, frame)
    threads = options.threads or threads_for(request, nodes())
    seconds = seconds_of(options, frame, threads)
    chunk = options.chunk or chunk_for(seconds, options.task_minutes, len(frames), max_tasks())
    return Submission(polyrecon, frames, chunk, threads, request, limit_of(options, request), options.gpus)


def check_options(polyrecon, options):
    """Lets the program check the options of `polyrecon denoise`, so that no task fails because of them."""
    words = ["-i", options.input, "-o", options.output, "--frames", options.frames, "--skip-existing"]
    try:
        polyrecon.check_options("denoise", *words, *options.options)
    except DriverError as error:
        raise DriverError(error.code, f"options of polyrecon denoise: {error}") from error


def value_of(option, words, default):
    """The value of an option among words of `polyrecon denoise`."""
    value = default
    for at, word in enumerate(words):
        if word == option and at + 1 < len(words):
            value = words[at + 1]
        elif word.startswith(f"{option}="):
            value = word.partition("=")[2]
    return value


def quality_of(words):
    return value_of("--quality", words, DEFAULT_QUALITY)


def radius_of(words):
    radius = value_of("--frame-radius", words, str(DEFAULT_FRAME_RADIUS))
    if not radius.isdecimal():
        raise DriverError(ExitCode.USAGE, f"--frame-radius {radius}: must be a whole number")
    return int(radius)


def model_of(options):
    return Model(options.model) if options.model else Model()


def words_of(options, words):
    """These options with their values among words of `polyrecon denoise`."""
    found = []
    for at, word in enumerate(words):
        if word in options:
            found += words[at : at + 2]
        elif word.startswith(tuple(f"{option}=" for option in options if option.startswith("--"))):
            found.append(word)
    return found


def first_frame(options, frames, polyrecon):
    """The Frame of the first render that exists and is not broken; the job's report names those that are. Before
    rendering there may be none: None, if the options suffice."""
    aovs = words_of(AOV_OPTIONS, options.options)  # What a pattern or "all" stands for, the program knows.
    broken = None
    for frame in frames:
        path = frame_path(options.input, frame)
        if not os.path.exists(path):
            continue
        try:
            inspection = polyrecon.run("inspect", "--json", path, *aovs)
        except DriverError as error:
            if error.code != ExitCode.BAD_INPUT:
                raise
            broken = broken or error
            continue
        check_layers(polyrecon, options, frame)
        return frame_of(json.loads(inspection))
    if broken:
        raise broken
    if options.memory and options.threads and options.chunk:
        return None
    raise DriverError(
        ExitCode.MISSING,
        f"{frame_path(options.input, frames[0])}: no render exists yet, so memory and time are unknown: "
        "give --memory, --threads and --chunk",
    )


def check_layers(polyrecon, options, frame):
    """Raises DriverError where a render lacks a layer that the options name, as all renders then do."""
    named = words_of((*AOV_OPTIONS, "--map"), options.options)
    if not named:
        return
    words = ["-i", options.input, "-o", options.output, "--frames", frame, "--dry-run", "--strict", "--quiet"]
    try:
        polyrecon.run("denoise", *words, *named)
    except DriverError as error:
        raise DriverError(error.code, f"options of {error}") from error  # It begins with "polyrecon denoise: ".


def counted(number, thing):
    return f"{number} {thing}{'' if number == 1 else 's'}"


def request_of(options, frame):
    """The bytes of memory that a task needs."""
    if options.memory:
        return options.memory
    return model_of(options).request_bytes(frame, quality_of(options.options), frame.aovs, radius_of(options.options))


def limit_of(options, request):
    """The program's --max-memory for a task with so many bytes.

    If the bytes come from the model, the limit is so high that the frame is not divided into tiles, as in the
    measurement. The program's estimate of its memory is higher than its use."""
    return int(request / MEMORY_MARGIN) if options.memory else 4 * request


def seconds_of(options, frame, threads):
    """Seconds of one frame by the model; 0 without a frame."""
    if not frame:
        return 0
    quality, radius = quality_of(options.options), radius_of(options.options)
    return model_of(options).wall_seconds(frame, quality, threads, radius)
