"""The command `blender -c polyrecon COMMAND ...`. The drivers render with this Blender; other commands are
polyrecon's."""

import subprocess

from . import preferences, programs

_DRIVERS = {"adaptive": "adaptive", "render-passes": "render_passes"}
_HELP = """usage: blender -c polyrecon COMMAND ...

  adaptive       render a .blend file with the adaptive loop and this Blender
  render-passes  render a .blend file in subsets of its samples and merge them
  denoise, merge, inspect, samplemap, preview, compare
                 commands of the program polyrecon

blender -c polyrecon COMMAND --help shows options and examples."""


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
    except programs.SetupError as error:
        print(f"polyrecon: {error}")
        return 4
    try:
        return subprocess.run(command, env=preferences.environment(), check=False).returncode
    except KeyboardInterrupt:
        return 130
