"""Child processes. Each is started without a shell, leads a process group, and ends with the driver."""

import contextlib
import os
import signal
import subprocess

GRACE_SECONDS = 5


def start(words, **options):
    """Starts a command as the leader of a new process group; returns its subprocess.Popen."""
    return subprocess.Popen(
        [word if isinstance(word, os.PathLike) else str(word) for word in words], start_new_session=True, **options
    )


def stop(child):
    """Ends the child and all processes that it started: by SIGTERM, and by SIGKILL after GRACE_SECONDS."""
    for signal_number, seconds in ((signal.SIGTERM, GRACE_SECONDS), (signal.SIGKILL, None)):
        with contextlib.suppress(ProcessLookupError):
            os.killpg(child.pid, signal_number)
        try:
            child.wait(seconds)
            break
        except subprocess.TimeoutExpired:
            continue
    with contextlib.suppress(ProcessLookupError):  # Grandchildren may outlive their parent.
        os.killpg(child.pid, signal.SIGKILL)


def run(words, timeout=None, **options):
    """Runs a command to its end; returns (exit code, standard output, standard error).

    If a time limit (subprocess.TimeoutExpired) or a signal interrupts the wait, the child's process group is ended
    before the exception is passed on."""
    return run_side_by_side([words], timeout, **options)[0]


def decoded(output):
    """The text of bytes that a child printed. Python's text mode would turn carriage returns into ends of lines, and a
    name in a file could forge a line with one."""
    return output.decode("utf-8", "replace")


def lines_of(text):
    """The lines of a text that a child printed, divided at "\\n" alone."""
    return text.removesuffix("\n").split("\n") if text else []


def run_side_by_side(commands, timeout=None, **options):
    """Runs several commands concurrently; returns what `run` returns for each, in their order.

    A command that prints more than a pipe holds waits until the commands before it have ended."""
    children = []
    try:
        for words in commands:
            children.append(start(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, **options))
        outputs = [child.communicate(timeout=timeout) for child in children]
        return [(child.returncode, *map(decoded, output)) for child, output in zip(children, outputs)]
    except BaseException:
        for child in children:
            stop(child)
            child.stdout.close()
            child.stderr.close()
        raise
