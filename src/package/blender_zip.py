#!/usr/bin/env python3
"""Packs the Blender extension as one zip: the add-on with the wheel of polyrecon and those of the modules that
Blender's Python lacks. Needs pip and the network.

    src/package/wheel/wheel.sh && src/package/blender_zip.py build/packages/polyrecon-*.whl
    src/package/blender_zip.py WHEEL [ZIP]        # default: build/packages/polyrecon_blender.zip"""

import pathlib
import shutil
import subprocess
import sys
import tempfile
import zipfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
SOURCE = ROOT / "pipelines" / "blender" / "extension"
# Blender's Python has numpy and OpenImageIO. MarkupSafe, which jinja2 needs, is compiled for each Python of a Blender
# since 4.2; rich is imported by a terminal's progress alone, without what it needs for other purposes.
PURE = ("jinja2", "rich")
PYTHONS = ("3.11", "3.13")


def download(folder, *words):
    pip = [sys.executable, "-m", "pip", "download", "--quiet", "--disable-pip-version-check", "--no-deps"]
    subprocess.run([*pip, "--only-binary=:all:", "--dest", str(folder), *words], check=True)


def pack(wheel, target):
    with tempfile.TemporaryDirectory() as temporary:
        folder = pathlib.Path(temporary) / "polyrecon"
        shutil.copytree(SOURCE, folder, ignore=shutil.ignore_patterns("__pycache__", "*.zip"))
        wheels = folder / "wheels"
        wheels.mkdir()
        shutil.copy(wheel, wheels)
        download(wheels, *PURE)
        for python in PYTHONS:
            download(wheels, "--python-version", python, "--platform", "manylinux2014_x86_64", "MarkupSafe")
        names = sorted(path.name for path in wheels.iterdir())
        manifest = folder / "blender_manifest.toml"
        lines = ['platforms = ["linux-x64"]', "wheels = [", *(f'  "./wheels/{name}",' for name in names), "]", ""]
        text = manifest.read_text(encoding="utf-8")
        manifest.write_text(text.replace("[permissions]", "\n".join(lines) + "\n[permissions]"), encoding="utf-8")
        with zipfile.ZipFile(target, "w", zipfile.ZIP_DEFLATED) as archive:
            for path in sorted(folder.rglob("*")):
                if path.is_file():
                    archive.write(path, path.relative_to(folder))


def main():
    if len(sys.argv) not in (2, 3):
        sys.exit(__doc__)
    target = pathlib.Path(sys.argv[2] if len(sys.argv) == 3 else ROOT / "build" / "packages" / "polyrecon_blender.zip")
    target.parent.mkdir(parents=True, exist_ok=True)
    pack(pathlib.Path(sys.argv[1]), target)
    print(f"{target}: {target.stat().st_size / 1e6:.1f} MB")


if __name__ == "__main__":
    main()
