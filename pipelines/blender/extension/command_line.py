"""`blender -c polyrecon COMMAND ...`: the loop and the passes by this Blender; every other command is polyrecon's own."""

import subprocess

from . import preferences, programs

_DRIVERS = {"adaptive": "adaptive.py", "render-passes": "render_passes.py"}
_HELP = """usage: blender -c polyrecon COMMAND ...

  adaptive       the adaptive loop on a .blend, rendered by this Blender
  render-passes  a .blend as subsets of its samples, merged, ready to denoise
  denoise, merge, inspect, samplemap, preview, compare
                 the program polyrecon's own commands

blender -c polyrecon COMMAND --help tells more, with examples."""


def run(words):
    """Returns the command's exit code."""
    if not words or words[0] in ("-h", "--help"):
        print(_HELP)
        return 0 if words else 2
    try:
        if words[0] in _DRIVERS:
            command = [*preferences.driver_words(_DRIVERS[words[0]]), *words[1:]]
        else:
            command = [preferences.program(), *words]
    except programs.Problem as problem:
        print(f"polyrecon: {problem}")
        return 4
    try:
        return subprocess.run(command, env=programs.environment(), check=False).returncode
    except KeyboardInterrupt:
        return 130
