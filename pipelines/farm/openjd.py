#!/usr/bin/env python3
"""Writes an Open Job Description bundle for a sequence: a job template with the requirements of a worker, and its
parameters."""

import math
import os
import pathlib
import shutil
import sys

if not __package__:  # run as a script from a checkout
    sys.path[0] = str(pathlib.Path(__file__).resolve().parents[2])
    sys.dont_write_bytecode = True  # A checkout stays as it is.
    __package__ = "pipelines.farm"

from ..common import modules
from ..common.arguments import Parser
from ..common.errors import DriverError, ExitCode, run_main
from ..common.files import write_text
from ..common.frame_names import ranges_text
from ..common.terminal import quiet_or_print
from .job_options import add_job_options, parse_words, size
from .requirements import MIB, Node
from .submission import counted, quality_of, submission_of

TEMPLATE = pathlib.Path(__file__).with_name("template.yaml")
MAX_TASKS = 1000
EXAMPLES = """\
examples:
  %(prog)s -i shot.####.exr -o clean/shot.####.exr --frames 1-240 --bundle denoise_shot
  deadline bundle submit denoise_shot
  %(prog)s -i shot.####.exr -o clean/shot.####.exr --frames 1-240 --bundle denoise_shot \\
      --worker-cpus 16 --worker-memory 64G -- --quality best --aov 'Diffuse Direct'
"""


def load_template():
    try:
        import yaml
    except ImportError as error:
        raise DriverError(ExitCode.MISSING, modules.advice(["yaml"])) from error
    return yaml, yaml.safe_load(TEMPLATE.read_text())


def range_text(frames):
    """Ranges without steps, which Open Job Description and the program write in the same way."""
    return ranges_text(sorted(frames))


def template_for(template, tasks, options):
    """The template with the requirements of a worker, and with further options of the program."""
    denoise, report = template["steps"]
    amounts = {"vcpu": tasks.threads, "memory": math.ceil(tasks.request / MIB)}
    if tasks.gpus:
        amounts["gpu"] = tasks.gpus
    denoise["hostRequirements"] = {
        "amounts": [{"name": f"amount.worker.{name}", "min": least} for name, least in amounts.items()]
    }
    for step in (denoise, report):
        step["script"]["actions"]["onRun"]["args"] += options
    return template


def without_quality(words):
    """The options without --quality, which is a parameter of the template."""
    kept = list(words)
    while "--quality" in kept:
        at = kept.index("--quality")
        del kept[at : at + 2]
    return [word for word in kept if not word.startswith("--quality=")]


def programs_of(options, polyrecon):
    """The parameters for the programs on the workers, where these are not the installed commands on the PATH."""
    on_path = not options.polyrecon and shutil.which("polyrecon") == str(polyrecon.program)
    values = {} if on_path else {"Polyrecon": str(polyrecon.program)}
    if __package__ == "pipelines.farm":  # A checkout has no installed commands.
        values["PolyreconFarm"] = str(pathlib.Path(__file__).with_name("farm.py").resolve())
    return values


def write_bundle(options):
    worker = Node(options.worker_cpus, options.worker_memory)
    tasks = submission_of(options, lambda: [worker] if worker.memory else [], lambda: MAX_TASKS)
    yaml, template = load_template()
    template = template_for(template, tasks, without_quality(options.options))
    values = {
        "InputFolder": os.path.dirname(os.path.abspath(options.input)),
        "InputName": os.path.basename(options.input),
        "OutputFolder": os.path.dirname(os.path.abspath(options.output)),
        "OutputName": os.path.basename(options.output),
        "Frames": range_text(tasks.frames),
        "FramesPerTask": tasks.chunk,
        "Quality": quality_of(options.options),
        "Threads": tasks.threads,
        "MaxMemory": str(tasks.limit),
        **programs_of(options, tasks.polyrecon),
    }
    folder = pathlib.Path(options.bundle)
    parameters = {"parameterValues": [{"name": name, "value": value} for name, value in values.items()]}
    write_text(folder / "template.yaml", yaml.safe_dump(template, sort_keys=False))
    write_text(folder / "parameter_values.yaml", yaml.safe_dump(parameters, sort_keys=False))
    say = quiet_or_print(options)
    chunk = f"tasks of up to {counted(tasks.chunk, 'frame')}, each with {tasks.needs}"
    say(f"{folder}: {counted(len(tasks.frames), 'frame')} in {chunk}")
    say(f"checked with {tasks.polyrecon.describe()}; workers run {values.get('Polyrecon', 'the one on their PATH')}")
    if options.verbose:
        say(*(f"{name}: {value}" for name, value in values.items()))


def arguments(words):
    parser = Parser("polyrecon-farm openjd", description=__doc__, epilog=EXAMPLES)
    add_job_options(parser)
    parser.add_argument(
        "--bundle", required=True, metavar="FOLDER", help="folder for the template and its parameter values"
    )
    parser.add_argument("--worker-cpus", type=int, default=0, metavar="N", help="processors of a worker, 0 if unknown")
    parser.add_argument(
        "--worker-memory", type=size, default=0, metavar="SIZE", help="memory of a worker, such as 64G; 0 if unknown"
    )
    return parse_words(parser, words)


def main(words=None):
    return run_main(
        "polyrecon-farm", lambda words: write_bundle(arguments(sys.argv[1:] if words is None else words)), words
    )


if __name__ == "__main__":
    sys.exit(main())
