"""Children: started without a shell, in a process group of their own, and never left behind."""

import os
import signal
import subprocess

GRACE_SECONDS = 5


def start(words, **options):
    """subprocess.Popen of a list of words, as the leader of a new process group."""
    return subprocess.Popen(
        [word if isinstance(word, os.PathLike) else str(word) for word in words], start_new_session=True, **options
    )


def stop(child):
    """Ends the child and all that it started: asked first, killed after GRACE_SECONDS."""
    for signal_number, seconds in ((signal.SIGTERM, GRACE_SECONDS), (signal.SIGKILL, None)):
        try:
            os.killpg(child.pid, signal_number)
        except ProcessLookupError:
            pass
        try:
            child.wait(seconds)
            break
        except subprocess.TimeoutExpired:
            continue
    try:  # grandchildren that outlived their parent
        os.killpg(child.pid, signal.SIGKILL)
    except ProcessLookupError:
        pass


def run(words, timeout=None, **options):
    """Runs a command to its end; returns (exit code, standard output, standard error). Whatever interrupts the wait,
    a time limit (subprocess.TimeoutExpired) or a signal, the child's group is ended first."""
    return run_side_by_side([words], timeout, **options)[0]


def run_side_by_side(commands, timeout=None, **options):
    """The same for several commands at once, in their order; each prints a few lines at most."""
    children = []
    try:
        for words in commands:
            children.append(
                start(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, errors="replace", **options)
            )
        said = [child.communicate(timeout=timeout) for child in children]
        return [(child.returncode, *texts) for child, texts in zip(children, said)]
    except BaseException:
        for child in children:
            stop(child)
            child.stdout.close()
            child.stderr.close()
        raise
