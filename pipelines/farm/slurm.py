#!/usr/bin/env python3
"""Denoises a sequence on a Slurm cluster: an array job with a task for each chunk of frames, then a job for the
report."""

import dataclasses
import functools
import itertools
import math
import os
import pathlib
import re
import shlex
import shutil
import stat
import sys
import time

if not __package__:  # run as a script from a checkout
    sys.path[0] = str(pathlib.Path(__file__).resolve().parents[2])
    sys.dont_write_bytecode = True  # A checkout stays as it is.
    __package__ = "pipelines.farm"

from ..common import process
from ..common.arguments import Parser
from ..common.decode import InvalidFileError, decode, read_json
from ..common.errors import DriverError, ExitCode, run_main
from ..common.files import open_regular, write_text
from ..common.terminal import quiet_or_print
from .job import JOB_FILE, REPORT_FILE, Job
from .job_options import add_job_options, parse_words, positive
from .requirements import MIB, Node
from .submission import counted, submission_of

EXAMPLES = """\
examples:
  %(prog)s -i shot.####.exr -o clean/shot.####.exr --frames 1-240
  %(prog)s -i shot.####.exr -o clean/shot.####.exr --frames 1-240 --after 4711 \\
      --partition night --sbatch=--account=film --wait -- --quality best --aov 'Diffuse Direct'
  %(prog)s -i shot.####.exr -o clean/shot.####.exr --frames 1-240 --gpus 1 -- --prior oidn
  %(prog)s -i shot.####.exr -o clean/shot.####.exr --frames 1-240 --dry-run
  polyrecon-farm report clean/polyrecon_farm/shot        # progress, at any time
"""
REPORT_LOG = "report.txt"
DEFAULT_MAX_TASKS = 1000  # of an array, as Slurm is installed
POLL_SECONDS = 2
MAX_UNANSWERED = 20  # calls of squeue
# The script of a task or of the report. sbatch copies it, so it names the folder of the drivers.
SCRIPT = """\
#!/usr/bin/env python3
import sys
sys.dont_write_bytecode = True
sys.path.insert(0, {root!r})
from {module} import main
sys.exit(main({words!r}))
"""


def slurm(*words):
    """Runs a command of Slurm; returns its output."""
    if not shutil.which(words[0]):
        raise DriverError(ExitCode.MISSING, f"{words[0]} is not on the PATH: run this on a machine of the cluster")
    code, output, errors = process.run(words, timeout=120)
    if code:
        why = " ".join(errors.split()).replace(f"{words[0]}: ", "") or f"ended with {code}"
        raise DriverError(ExitCode.USAGE, f"{words[0]}: {why}")
    return output


def answers():
    """Whether this machine is one of a cluster whose controller answers."""
    return shutil.which("scontrol") is not None and process.run(["scontrol", "show", "config"], timeout=120)[0] == 0


def nodes_of(partition):
    """The kinds of node of a partition. A cluster that does not manage memory reports 1 MB."""
    words = ["sinfo", "-h", "-N", "-o", "%c %m", *(["-p", partition] if partition else [])]
    nodes = set()
    for line in slurm(*words).splitlines():
        cpus, megabytes = (int(word.rstrip("+")) for word in line.split())
        nodes.add(Node(cpus, megabytes * MIB if megabytes > 1 else 0))
    if not nodes:
        raise DriverError(ExitCode.USAGE, f"--partition {partition}: has no nodes")
    return nodes


def max_tasks():
    """The largest number of tasks of an array."""
    match = re.search(r"^MaxArraySize\s*=\s*(\d+)", slurm("scontrol", "show", "config"), re.MULTILINE)
    return max(1, int(match[1]) - 1) if match else DEFAULT_MAX_TASKS


def tasks_of(options):
    """The Submission, with a request of 0 if the cluster does not manage memory, and lines about program and cluster.
    Without Slurm, which a dry run does not need, nothing is known about the nodes."""
    known = not options.dry_run or answers()
    nodes = functools.cache(lambda: nodes_of(options.partition) if known else ())
    tasks = submission_of(options, nodes, lambda: max_tasks() if known else DEFAULT_MAX_TASKS)
    about = [tasks.polyrecon.describe()]
    if not known:
        about.append("no Slurm answers here: threads, memory and tasks are those for nodes that are not known")
    elif not any(node.memory for node in nodes()):
        tasks = dataclasses.replace(tasks, request=0)
    return tasks, about


def job_of(options, tasks):
    return Job(
        input=os.path.abspath(options.input),
        output=os.path.abspath(options.output),
        frames=tasks.frames,
        polyrecon=str(tasks.polyrecon.program),
        options=options.options,
        chunk=tasks.chunk,
        threads=tasks.threads,
        memory=tasks.limit,
        request=tasks.request,
    )


def common_words(options, job_name, folder, log):
    """The options of sbatch that both jobs have. Slurm expands % in the name of a log."""
    words = ["sbatch", "--parsable", f"--job-name={job_name}", "--open-mode=append", "--requeue"]
    words.append(f"--output={str(folder).replace('%', '%%')}/{log}")
    if options.partition:
        words.append(f"--partition={options.partition}")
    return [*words, *options.sbatch]


def array_words(options, job, name, folder):
    limit = f"%{options.max_running}" if options.max_running else ""
    words = [*common_words(options, name, folder, "log.%a.txt"), f"--array=0-{len(job.chunks) - 1}{limit}"]
    words += ["--ntasks=1", f"--cpus-per-task={job.threads}"]
    if job.request:
        words.append(f"--mem={math.ceil(job.request / MIB)}M")
    if options.gpus:
        words.append(f"--gres=gpu:{options.gpus}")
    if options.after:
        words.append(f"--dependency=afterany:{options.after}")
    return [*words, str(folder / "task")]


def report_words(options, job, name, folder, array):
    words = [*common_words(options, f"{name}-report", folder, REPORT_LOG), f"--dependency=afterany:{array}"]
    words += ["--ntasks=1", f"--cpus-per-task={job.threads}"]
    if job.request:
        words.append(f"--mem={math.ceil(job.request / MIB)}M")
    return [*words, str(folder / "report")]


def write_script(path, module, words):
    package = f"{__package__}.{module}"
    root = str(pathlib.Path(__file__).resolve().parents[__package__.count(".") + 1])
    write_text(path, SCRIPT.format(root=root, module=package, words=words))


def holds_another(folder, job):
    return (folder / JOB_FILE).exists() and Job.load(folder) != job


def job_folder(options, name, job):
    """The folder of the job. Slurm writes logs into it, and ends a job that has a backslash in the path of its log."""
    folder = named_folder(options, name, job)
    if "\\" in str(folder):
        raise DriverError(
            ExitCode.USAGE, f"{folder}: Slurm writes no log into a folder with a backslash: name another --folder"
        )
    return folder


def named_folder(options, name, job):
    """--folder, else one in the folder of the results. If that holds another job, whose tasks may still run, a number
    is added to its name."""
    if options.folder:
        folder = pathlib.Path(options.folder).absolute()
        if holds_another(folder, job):
            raise DriverError(ExitCode.USAGE, f"{folder}: holds another job; name another --folder")
        return folder
    jobs = pathlib.Path(job.output).parent / "polyrecon_farm"
    names = itertools.chain([name], (f"{name}_{number}" for number in itertools.count(2)))
    return next(jobs / one for one in names if not holds_another(jobs / one, job))


def make_folder(folder, job):
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise DriverError(ExitCode.OUTPUT, f"{folder}: {error.strerror}") from error
    for entry in list(os.scandir(folder)):  # Slurm appends to what has the name of a log.
        status = entry.stat(follow_symlinks=False)
        if stat.S_ISLNK(status.st_mode) or (stat.S_ISREG(status.st_mode) and status.st_nlink > 1):
            raise DriverError(ExitCode.OUTPUT, f"{entry.path}: is a link: remove it, or name another --folder")
    for old in (REPORT_LOG, REPORT_FILE):
        (folder / old).unlink(missing_ok=True)
    job.save(folder)
    write_script(folder / "task", "task", [str(folder)])
    write_script(folder / "report", "report", [str(folder)])


def describe(job, tasks):
    chunks = f"{counted(len(job.chunks), 'task')} of up to {counted(job.chunk, 'frame')}"
    return f"{counted(len(job.frames), 'frame')}: {chunks}, each with {tasks.needs}"


def submit(options):
    tasks, about = tasks_of(options)
    job = job_of(options, tasks)
    name = options.name or re.sub(r"\W+", "_", pathlib.Path(options.input).name.split("#")[0].split("%")[0]).strip("_")
    name = name or "polyrecon"
    if "/" in name or name in (".", ".."):
        raise DriverError(ExitCode.USAGE, f"--name {name}: is the name of a folder, too: give one without /")
    folder = job_folder(options, name, job)
    say = quiet_or_print(options)
    say(*about, describe(job, tasks))
    if options.verbose:
        say(f"a task: {shlex.join(job.words(job.chunks[0]))}")
    if options.verbose or options.dry_run:
        say(shlex.join(array_words(options, job, name, folder)))
        say(shlex.join(report_words(options, job, name, folder, "ARRAY")))
    if options.dry_run:
        return
    make_folder(folder, job)
    array = slurm(*array_words(options, job, name, folder)).strip().split(";")[0]
    report = slurm(*report_words(options, job, name, folder, array)).strip().split(";")[0]
    say(f"job {array} denoises, job {report} reports; their files are in {folder}")
    if options.wait:
        wait_for(report, folder, say)


def is_over(job):
    """Whether all tasks of the job have ended; None if Slurm does not answer, as a busy controller sometimes does not.

    Slurm removes a job some minutes after its end; a job that it does not know is over."""
    code, output, errors = process.run(["squeue", "-h", "-j", job, "-o", "%T"], timeout=120)
    if code and "Invalid job id" not in errors:
        return None
    return not output.strip()


def wait_for(job, folder, say):
    """Waits for the report and says it. Unfinished frames are an error."""
    unanswered = 0
    while not (over := is_over(job)):
        unanswered = unanswered + 1 if over is None else 0
        if unanswered == MAX_UNANSWERED:
            raise DriverError(ExitCode.INTERNAL, f"squeue does not answer; job {job} continues, see {folder}")
        time.sleep(POLL_SECONDS)
    say_report(folder, job, say)


def say_report(folder, job, say):
    """Says the report that the job has left in the folder. Unfinished frames are an error."""
    log = folder / REPORT_LOG
    try:
        found = read_json(folder / REPORT_FILE)
        unfinished = decode(str, found.get("unfinished") if isinstance(found, dict) else None, "unfinished")
        with open_regular(log) as file:
            text = process.decoded(file.read())
    except (InvalidFileError, OSError) as error:
        raise DriverError(ExitCode.INTERNAL, f"job {job} ended without a report ({error}), see {log}") from error
    say(*process.lines_of(text))
    if unfinished:
        raise DriverError(ExitCode.MISSING, f"not finished: {unfinished}")


def arguments(words):
    parser = Parser("polyrecon-farm slurm", description=__doc__)
    commands = parser.add_subparsers(dest="command", required=True, metavar="COMMAND", parser_class=Parser)
    sub = commands.add_parser(
        "submit", program="polyrecon-farm slurm submit", help=__doc__, description=__doc__, epilog=EXAMPLES
    )
    add_job_options(sub)
    sub.add_argument("--partition", metavar="NAME", help="partition of the cluster (default: the cluster's)")
    sub.add_argument("--after", metavar="JOB", help="start after the end of this job, such as the render")
    sub.add_argument(
        "--max-running", type=positive, metavar="N", help="limit of tasks that run concurrently, for slow storage"
    )
    sub.add_argument(
        "--sbatch", action="append", default=[], metavar="=OPTION", help="an option of sbatch (repeatable)"
    )
    sub.add_argument("--name", help="name of the job (default: that of the input)")
    sub.add_argument("--folder", help="folder of logs, records and report (default: in the folder of the results)")
    sub.add_argument(
        "--wait", action="store_true", help="wait for the report; the exit code is 4 if frames are unfinished"
    )
    sub.add_argument("--dry-run", action="store_true", help="print what would be submitted, and submit nothing")
    return parse_words(parser, words)


def main(words=None):
    return run_main("polyrecon-farm", lambda words: submit(arguments(sys.argv[1:] if words is None else words)), words)


if __name__ == "__main__":
    sys.exit(main())
