"""The options of a submission, for every engine, and the memory and seconds of a task that follow from them."""

import argparse
import json
import os
import re

from ..common.arguments import add_program, add_verbosity
from ..common.denoise_defaults import DEFAULT_FRAME_RADIUS, DEFAULT_QUALITY
from ..common.errors import DriverError, ExitCode
from ..common.frame_names import frame_path, is_pattern
from .requirements import MEMORY_MARGIN, Model, frame_of


def size(text):
    """The bytes of a text such as 512M or 4G."""
    match = re.fullmatch(r"(\d+(?:\.\d+)?)([KMGT]?)", text.strip().upper())
    if not match:
        raise argparse.ArgumentTypeError(f"{text}: write it as 512M or 4G")
    return int(float(match[1]) * 1024 ** (" KMGT".index(match[2] or " ")))


def positive(text):
    number = int(text)
    if number < 1:
        raise argparse.ArgumentTypeError(f"{text}: must be at least 1")
    return number


def pattern(text):
    if not is_pattern(text):
        raise argparse.ArgumentTypeError(f"{text}: needs #### or %04d for the frame")
    return text


def add_job_options(parser):
    add = parser.add_argument
    add(
        "-i",
        "--input",
        required=True,
        type=pattern,
        metavar="PATTERN",
        help="renders, such as shot.####.exr or shot.%%04d.exr",
    )
    add("-o", "--output", required=True, type=pattern, metavar="PATTERN", help="results; missing folders are made")
    add("--frames", required=True, metavar="RANGES", help="frames, such as 1-10,20-40x2")
    add("--chunk", type=positive, metavar="N", help="frames of a task (default: as many as take --task-minutes)")
    add("--task-minutes", type=float, default=10, metavar="M", help="minutes that a task takes")
    add(
        "--threads",
        type=positive,
        metavar="N",
        help="threads of a task (default: so that the tasks fill a node's memory)",
    )
    add("--memory", type=size, metavar="SIZE", help="memory of a task, such as 4G (default: by the measured model)")
    add(
        "--gpus",
        type=positive,
        default=0,
        metavar="N",
        help="graphics cards of a task, which --prior oidn uses (default: none)",
    )
    add(
        "--model",
        metavar="FILE",
        help="constants of your nodes, by tests/bench/farm_model.py (default: those of one machine)",
    )
    add_program(parser)
    add_verbosity(parser)


def parse_words(parser, words):
    """Parses the words before `--`. Those after it are options of `polyrecon denoise`."""
    at = words.index("--") if "--" in words else len(words)
    options = parser.parse_args(words[:at])
    options.options = words[at + 1 :]
    return options


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


def aov_words(words):
    """The options --aov among words of `polyrecon denoise`. What a pattern or "all" stands for, the program knows."""
    found = []
    for at, word in enumerate(words):
        if word in ("-l", "--aov"):
            found += words[at : at + 2]
        elif word.startswith("--aov="):
            found.append(word)
    return found


def first_frame(options, frames, polyrecon):
    """The Frame of the first render that exists. Before rendering there may be none: None, if the options suffice."""
    for frame in frames:
        path = frame_path(options.input, frame)
        if os.path.exists(path):
            return frame_of(json.loads(polyrecon.run("inspect", "--json", path, *aov_words(options.options))))
    if options.memory and options.threads and options.chunk:
        return None
    raise DriverError(
        ExitCode.MISSING,
        f"{frame_path(options.input, frames[0])}: no render exists yet, so memory and time are unknown: "
        "give --memory, --threads and --chunk",
    )


def counted(number, thing):
    return f"{number} {thing}{'' if number == 1 else 's'}"


def task_text(threads, request, gpus):
    """What a task needs, in words. request: bytes; 0 where memory is not managed."""
    words = [counted(threads, "thread")]
    if gpus:
        words.append(counted(gpus, "graphics card"))
    if request:
        words.append(f"{request / 1e9:.2f} GB")
    return words[0] if len(words) == 1 else f"{', '.join(words[:-1])} and {words[-1]}"


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
