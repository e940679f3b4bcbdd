#!/usr/bin/env python3
"""Checks man pages with mandoc, and completions in the shells: manual_test.py PROGRAM SHARE

The test types to bash and zsh on a terminal; fish has a command that lists completions.
"""

import os
import pathlib
import pty
import re
import select
import shutil
import subprocess
import sys
import tempfile
import time
import unittest

PROGRAM, SHARE = (pathlib.Path(word).resolve() for word in sys.argv[1:3])
COMMANDS = re.findall(
    r"^  ([a-z]+)  ", subprocess.run([PROGRAM, "--help"], capture_output=True, text=True).stdout, re.M
)
SECONDS = 90  # until a shell must have answered; on a busy machine zsh takes half a minute to read its completions


class Terminal:
    """A shell on a new terminal, in a folder with one file."""

    def __init__(self, words, folder):
        self.pid, self.descriptor = pty.fork()
        if self.pid == 0:
            os.chdir(folder)
            path = f"{PROGRAM.parent}:{os.environ['PATH']}"
            os.execvpe(words[0], words, {"PATH": path, "TERM": "dumb", "HOME": folder, "COLUMNS": "200"})
        self.seen = ""

    def type(self, keys, until):
        """Types keys and waits for a text that is not in the keys; returns whether the shell wrote it."""
        self.seen = ""
        os.write(self.descriptor, keys.encode())
        end = time.monotonic() + SECONDS
        while until not in self.seen and time.monotonic() < end:
            if select.select([self.descriptor], [], [], 0.1)[0]:
                self.seen += os.read(self.descriptor, 65536).decode(errors="replace")
        return until in self.seen

    def close(self):
        os.close(self.descriptor)
        os.waitpid(self.pid, 0)


class Manual(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.mkdtemp()
        self.addCleanup(shutil.rmtree, self.folder)
        pathlib.Path(self.folder, "noisy render.exr").touch()

    def shell(self, words, setup):
        terminal = Terminal(words, self.folder)
        self.addCleanup(terminal.close)
        self.assertTrue(terminal.type(f"{setup}; echo rea''dy\n", "ready"), terminal.seen)
        return terminal

    def check_completions(self, terminal):
        clear = "\x15"
        for keys, until in (
            ("polyrecon deno\t", "denoise "),
            ("polyrecon denoise --qual\t", "--quality "),
            ("polyrecon denoise --quality dr\t", "draft "),
            ("polyrecon denoise --progress js\t", "json "),
            ("polyrecon denoise -i noi\t", "noisy\\ render.exr"),
            ("polyrecon denoise --prior noi\t", "noisy\\ render.exr"),
            ("polyrecon inspect noi\t", "noisy\\ render.exr"),
            ("polyrecon --vers\t", "--version "),
        ):
            self.assertTrue(terminal.type(keys, until), (keys, terminal.seen))
            os.write(terminal.descriptor, clear.encode())

    def test_every_command_has_a_page_that_mandoc_accepts(self):
        self.assertGreaterEqual(len(COMMANDS), 6)
        pages = [SHARE / "man" / "man1" / f"polyrecon{suffix}.1" for suffix in ["", *("-" + c for c in COMMANDS)]]
        for page in pages:
            # The pages have no date, so that they are the same in every build; mandoc warns of it.
            lint = subprocess.run(
                ["mandoc", "-T", "lint", "-W", "warning", page], capture_output=True, text=True
            ).stdout
            self.assertEqual([line for line in lint.splitlines() if "missing date" not in line], [])

    def test_a_page_has_the_options_of_the_help(self):
        page = SHARE / "man" / "man1" / "polyrecon-denoise.1"
        text = subprocess.run(["mandoc", "-T", "ascii", "-O", "width=200", page], capture_output=True, text=True).stdout
        text = re.sub(r".\x08", "", text)
        options = subprocess.run([PROGRAM, "denoise", "--help"], capture_output=True, text=True).stdout
        for option in re.findall(r"^  (?:-\w,)?(--[a-z-]+)", options, re.M):
            self.assertIn(option, text)
        self.assertIn("polyrecon denoise -i render.exr -o clean.exr", text)

    def test_hidden_options_are_in_no_page_and_no_completion(self):
        """`--effects` is the former name of `--steps`, which still works."""
        for file in (path for path in SHARE.rglob("*") if path.is_file()):
            self.assertNotIn("effects", file.read_text(encoding="utf-8"), file)
        self.assertIn("--steps", (SHARE / "bash-completion" / "completions" / "polyrecon").read_text(encoding="utf-8"))

    def test_bash(self):
        script = SHARE / "bash-completion" / "completions" / "polyrecon"
        self.check_completions(self.shell(["bash", "--norc", "--noprofile", "-i"], f"source '{script}'"))

    def test_zsh(self):
        folder = SHARE / "zsh" / "site-functions"
        setup = f"unsetopt beep; fpath=('{folder}' $fpath); autoload -Uz compinit; compinit -u -d dump"
        self.check_completions(self.shell(["zsh", "-f", "-i"], setup))

    def test_fish(self):
        script = SHARE / "fish" / "vendor_completions.d" / "polyrecon.fish"

        def complete(line):
            command = f"source '{script}'; complete -C '{line}'"
            environment = {**os.environ, "HOME": self.folder, "PATH": f"{PROGRAM.parent}:{os.environ['PATH']}"}
            done = subprocess.run(
                ["fish", "--no-config", "-c", command], cwd=self.folder, env=environment, capture_output=True, text=True
            )
            self.assertEqual(done.stderr, "")
            return [word.split("\t")[0] for word in done.stdout.splitlines()]

        self.assertLessEqual(set(COMMANDS), set(complete("polyrecon ")))
        self.assertEqual(complete("polyrecon denoise --qual"), ["--quality"])
        self.assertEqual(complete("polyrecon denoise --quality dr"), ["draft"])
        self.assertEqual(complete("polyrecon denoise -i noi"), ["noisy render.exr"])
        self.assertEqual(complete("polyrecon denoise --prior noi"), ["noisy render.exr"])
        self.assertEqual(complete("polyrecon inspect noi"), ["noisy render.exr"])


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
