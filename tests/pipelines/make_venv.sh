#!/usr/bin/env bash
# Makes the Python of the drivers' tests in build/venv: Debian's Python with its packages (numpy, OpenImageIO, jinja2, rich,
# yaml), and in addition Blender 5.0, Mitsuba and LuxCore as modules, the command openjd, and ruff. Blender 5.2 needs Python
# 3.13: where there is one, build/venv_blender_5_2 has it. What is installed already is kept.
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
# Mitsuba and LuxCore write the files of a test. Without dependencies: LuxCore's is the compiler of a graphics card.
"$python" -c 'import importlib.util as u, sys; sys.exit(not (u.find_spec("mitsuba") and u.find_spec("pyluxcore")))' ||
  "$python" -m pip install --quiet --disable-pip-version-check --no-deps mitsuba==3.9.1 drjit==1.5.0 pyluxcore==2.11.2
# Open Image Denoise, for the tests of --prior oidn (CTest tells them where it is). Without it they are skipped.
"$python" -c 'import importlib.util as u, sys; sys.exit(not u.find_spec("pyoidn"))' ||
  "$python" -m pip install --quiet --disable-pip-version-check --no-deps pyoidn==2.5.1.0 ||
  echo "no pyoidn: the tests of --prior oidn are skipped"
blender_5_2=build/venv_blender_5_2
python_3_13=
for candidate in python3.13 "${PYENV_ROOT:-$HOME/.pyenv}"/versions/3.13.*/bin/python3; do
  if "$candidate" -c 'import ensurepip' 2>/dev/null; then  # pyenv's python3.13 may be one that does not run
    python_3_13=$candidate
    break
  fi
done
if [ -n "$python_3_13" ]; then
  [ -x "$blender_5_2/bin/python3" ] || "$python_3_13" -m venv "$blender_5_2"
  "$blender_5_2/bin/python3" -c 'import importlib.util as u, sys; sys.exit(not (u.find_spec("bpy") and u.find_spec("OpenImageIO")))' ||
    "$blender_5_2/bin/python3" -m pip install --quiet --disable-pip-version-check bpy==5.2.3 OpenImageIO==3.2.2.0
else
  echo "no Python 3.13: the tests with Blender 5.2 are skipped"
fi
# openjd: the farm's tests run job templates with it.
"$python" -c 'import importlib.util as u, sys; sys.exit(not u.find_spec("openjd.cli"))' 2>/dev/null ||
  "$python" -m pip install --quiet --disable-pip-version-check openjd-cli==0.8.0
# ruff formats and checks all Python of the tree. The version is fixed, since versions differ in layout and rules.
[ "$("$python" -m ruff --version 2>/dev/null)" = "ruff $ruff_version" ] ||
  "$python" -m pip install --quiet --disable-pip-version-check "ruff==$ruff_version"
"$python" -c 'import numpy, OpenImageIO, jinja2, rich'
