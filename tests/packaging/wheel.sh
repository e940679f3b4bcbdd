#!/usr/bin/env bash
# Builds the wheel and uses it in a fresh Debian 12 that has none of our packages, with each Python 3.9 to 3.13 that pyenv has,
# without Open Image Denoise and with it. Needs root, debootstrap and the network. The Debian is in build/debian_python.
#     tests/packaging/wheel.sh [WHEEL]      # WHEEL: one that is built already
set -euo pipefail
cd "$(dirname "$0")/../.."
root=$PWD/build/debian_python
mirror=${DEBIAN_MIRROR:-http://deb.debian.org/debian}

if [ $# -eq 0 ]; then
  echo "== the wheel"
  src/package/wheel/wheel.sh
fi
wheel=$(realpath "${1:-$(echo build/packages/polyrecon-*-py3-none-manylinux*.whl)}")
megabytes=$(($(stat -c %s "$wheel") / 1000000))
[ "$megabytes" -lt 60 ] || { echo "$wheel: $megabytes MB, more than 60" >&2; exit 1; }

# Functions for several x86-64 levels (POLYRECON_SIMD_CLONES) are chosen by relocations of this type.
rm -rf build/wheel/unpacked
python3 -m zipfile -e "$wheel" build/wheel/unpacked
for file in bin/polyrecon lib/libpolyrecon.so.1; do
  readelf --relocs --wide "build/wheel/unpacked/polyrecon/$file" | grep IRELATIV >/dev/null ||
    { echo "$wheel: $file is built for the oldest x86-64 alone" >&2; exit 1; }
done

echo "== a fresh Debian in $root"
# The packages are those that pyenv's Pythons are linked with.
[ -e "$root/etc/debian_version" ] || debootstrap --variant=minbase \
  --include=ca-certificates,libssl3,libffi8,libsqlite3-0,libexpat1,libreadline8,libncursesw6,libuuid1 bookworm "$root" "$mirror"
rm -rf "$root/try"
mkdir -p "$root/try"
cp "$wheel" tests/packaging/wheel_test.py samples/study_small_0.exr "$root/try/"
cp /etc/resolv.conf "$root/etc/resolv.conf"
# Where the network is reached by a certificate of its own, pip needs it there too.
[ -z "${PIP_CERT:-}" ] || cp "$PIP_CERT" "$root/try/certificates.pem"

# Runs a command in the Debian system, with an empty environment: ours may name programs that are not installed there. /proc is
# what the loader finds the wheel's libraries by.
inside() {
  unshare --pid --fork --kill-child --mount-proc="$root/proc" chroot "$root" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LC_ALL=C.UTF-8 \
    ${PIP_CERT:+PIP_CERT=/try/certificates.pem} ${PIP_INDEX_URL:+PIP_INDEX_URL="$PIP_INDEX_URL"} \
    ${http_proxy:+http_proxy="$http_proxy"} ${https_proxy:+https_proxy="$https_proxy"} bash -euc "cd /try; $1"
}

inside '! dpkg-query -W "libopenexr*" "libopenimageio*" "libopencolorio*" "libimath*" "libtbb*" "libfmt*" 2>/dev/null | grep .'
tried=
for python in "${PYENV_ROOT:-$HOME/.pyenv}"/versions/3.{9,10,11,12,13}.*/bin/python3; do
  [ -x "$python" ] || continue
  version=$("$python" -c 'import sys; print("%d.%d" % sys.version_info[:2])')
  tried+=" $version"
  # Python, without its tests and installed packages, is copied to the same place, since its paths are compiled in.
  tar -C / -c --exclude=test --exclude='site-packages/*' --exclude=__pycache__ "${python%/bin/python3}" 2>/dev/null |
    tar -C "$root" -x
  echo "== Python $version"
  inside "'$python' -m venv '$version'
    '$version/bin/python3' -m pip install --quiet --disable-pip-version-check polyrecon-*.whl
    '$version/bin/python3' wheel_test.py /try"
  echo "== Python $version, with Open Image Denoise"
  inside "'$version/bin/python3' -m pip install --quiet --disable-pip-version-check \"\$(echo /try/polyrecon-*.whl)[oidn]\"
    '$version/bin/python3' wheel_test.py /try Wheel.test_open_image_denoise
    rm -rf '$version'"
done
[ -n "$tried" ] || { echo "pyenv has no Python from 3.9 to 3.13" >&2; exit 1; }
echo "done: $wheel, $megabytes MB, with Python$tried"
