#!/usr/bin/env bash
# The Python of the drivers' tests, in build/venv: Debian's own with its packages (numpy, OpenImageIO, jinja2, rich, yaml),
# and beside them Blender 5 as a module and the command openjd. Does nothing where it is there already.
set -euo pipefail
cd "$(dirname "$0")/../.."
python=build/venv/bin/python3
if ! [ -x "$python" ]; then
  echo "making build/venv"
  /usr/bin/python3 -m venv --system-site-packages build/venv
fi
# Debian's numpy is 1.24; bpy would bring a newer one, which Debian's OpenImageIO module would not load.
"$python" -c 'import importlib.util as u, sys; sys.exit(not u.find_spec("bpy"))' ||
  "$python" -m pip install --quiet --disable-pip-version-check --no-deps bpy==5.0.1
# The reader of Open Job Description templates that the farm's tests run.
"$python" -c 'import importlib.util as u, sys; sys.exit(not u.find_spec("openjd.cli"))' 2>/dev/null ||
  "$python" -m pip install --quiet --disable-pip-version-check openjd-cli==0.8.0
"$python" -c 'import numpy, OpenImageIO, jinja2, rich'
