#!/usr/bin/env bash
# Makes the Python of the drivers' tests in build/venv: Debian's Python with its packages (numpy, OpenImageIO, jinja2, rich,
# yaml), and in addition Blender 5 as a module, the command openjd, and ruff. What is installed already is kept.
set -euo pipefail
cd "$(dirname "$0")/../.."
python=build/venv/bin/python3
ruff_version=0.17.6
if ! [ -x "$python" ]; then
  echo "making build/venv"
  /usr/bin/python3 -m venv --system-site-packages build/venv
fi
# bpy without its dependencies: it would install a newer numpy, which Debian's OpenImageIO module cannot load.
"$python" -c 'import importlib.util as u, sys; sys.exit(not u.find_spec("bpy"))' ||
  "$python" -m pip install --quiet --disable-pip-version-check --no-deps bpy==5.0.1
# openjd: the farm's tests run job templates with it.
"$python" -c 'import importlib.util as u, sys; sys.exit(not u.find_spec("openjd.cli"))' 2>/dev/null ||
  "$python" -m pip install --quiet --disable-pip-version-check openjd-cli==0.8.0
# ruff formats and checks all Python of the tree. The version is fixed, since versions differ in layout and rules.
[ "$("$python" -m ruff --version 2>/dev/null)" = "ruff $ruff_version" ] ||
  "$python" -m pip install --quiet --disable-pip-version-check "ruff==$ruff_version"
"$python" -c 'import numpy, OpenImageIO, jinja2, rich'
