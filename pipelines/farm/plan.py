"""What all engines' commands share: their options, and how a job's memory, threads and chunks follow from the model."""

import argparse
import json
import os
import re

from ..common.errors import DriverError, ExitCode
from ..common.frame_names import frame_path, is_pattern
from .requirements import DEFAULT_RADIUS, MEMORY_MARGIN, Model, frame_of


def size(text):
    """Bytes of 512M, 4G."""
    match = re.fullmatch(r"(\d+(?:\.\d+)?)([KMGT]?)", text.strip().upper())
    if not match:
        raise argparse.ArgumentTypeError(f"{text}: write 512M or 4G")
    return int(float(match[1]) * 1024 ** (" KMGT".index(match[2] or " ")))


def positive(text):
    number = int(text)
    if number < 1:
        raise argparse.ArgumentTypeError(f"{text}: must be positive")
    return number


def pattern(text):
    if not is_pattern(text):
        raise argparse.ArgumentTypeError(f"{text}: needs #### or %04d for the frame")
    return text


def add_plan_options(parser):
    add = parser.add_argument
    add(
        "-i", "--input", required=True, type=pattern, metavar="PATTERN", help="renders: shot.####.exr or shot.%%04d.exr"
    )
    add("-o", "--output", required=True, type=pattern, metavar="PATTERN", help="results, in a folder that exists")
    add("--frames", required=True, metavar="RANGES", help="1-10,20-40x2")
    add("--chunk", type=positive, metavar="N", help="frames of a task (default: --task-minutes of work)")
    add("--task-minutes", type=float, default=10, metavar="M", help="length of a task (default: 10)")
    add("--threads", type=positive, metavar="N", help="of a task (default: what leaves no memory of a node over)")
    add("--memory", type=size, metavar="SIZE", help="of a task, 4G (default: what the measured model says)")
    add("--model", metavar="FILE", help="constants that tests/bench/farm_model.py measured on your nodes")
    add("--polyrecon", metavar="PATH", help="the program")


def parse_words(parser, words):
    """Parses up to `--`; what follows are words of `polyrecon denoise`."""
    at = words.index("--") if "--" in words else len(words)
    options = parser.parse_args(words[:at])
    options.options = words[at + 1 :]
    return options


def value_of(option, words, default):
    """What words of `polyrecon denoise` give as an option."""
    value = default
    for at, word in enumerate(words):
        if word == option and at + 1 < len(words):
            value = words[at + 1]
        elif word.startswith(f"{option}="):
            value = word.partition("=")[2]
    return value


def quality_of(words):
    return value_of("--quality", words, "standard")


def radius_of(words):
    radius = value_of("--frame-radius", words, str(DEFAULT_RADIUS))
    if not radius.isdecimal():
        raise DriverError(ExitCode.USAGE, f"--frame-radius {radius}: write a number")
    return int(radius)


def model_of(options):
    return Model(options.model) if options.model else Model()


def first_frame(options, frames, polyrecon):
    """What the model needs to know, of the first frame that is there; before the render there may be none."""
    for frame in frames:
        path = frame_path(options.input, frame)
        if os.path.exists(path):
            return frame_of(json.loads(polyrecon.run("inspect", "--json", path)))
    if options.memory and options.threads and options.chunk:
        return None
    raise DriverError(
        ExitCode.MISSING,
        f"{frame_path(options.input, frames[0])}: no frame is there to tell memory and time from: "
        "give --memory, --threads and --chunk",
    )


def request_of(options, frame):
    """Bytes to ask for each task."""
    if options.memory:
        return options.memory
    aovs = sum(word in ("-l", "--aov") or word.startswith("--aov=") for word in options.options)
    return model_of(options).request_bytes(frame, quality_of(options.options), aovs, radius_of(options.options))


def limit_of(options, request):
    """--max-memory of the program. Where the model was asked the frame fits and is not cut into tiles, as when it was
    measured: the limit is out of reach, since the program reckons more carefully than it uses."""
    return int(request / MEMORY_MARGIN) if options.memory else 4 * request


def seconds_of(options, frame, threads):
    """Of one frame; 0 where there is none to tell it from."""
    words = options.options
    return model_of(options).wall_seconds(frame, quality_of(words), threads, radius_of(words)) if frame else 0
