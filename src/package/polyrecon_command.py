#!python
"""The command polyrecon of a Python environment: becomes the program in the installed package."""

import importlib.util
import os
import sys

package = importlib.util.find_spec("polyrecon").submodule_search_locations[0]
program = os.path.join(package, "bin", "polyrecon")
os.execv(program, [program, *sys.argv[1:]])
