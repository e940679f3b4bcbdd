#!/usr/bin/env bash
# Installs the three Debian packages in a fresh Debian 12, denoises a frame there and builds programs against the libraries.
# Needs root, debootstrap and the network. Takes minutes, so tests/run.sh does not run it.
#
#     tests/packaging/run.sh [FOLDER]      # FOLDER: for the Debian system; default build/debian
set -euo pipefail
cd "$(dirname "$0")/../.."
root=$(realpath -m "${1:-build/debian}")
mirror=${DEBIAN_MIRROR:-http://deb.debian.org/debian}

echo "== packages"
cmake --preset deb
cmake --build --preset deb
rm -f build/packages/*.deb
cpack --config build/deb/CPackConfig.cmake -G DEB -B build/packages
if command -v lintian >/dev/null; then
  # Information that a string of two overlapping parts looks like a misspelt word is no fault.
  lintian --info --display-info --suppress-tags spelling-error-in-binary --fail-on error,warning,info build/packages/*.deb
else
  echo "lintian is not installed: the packages are not checked"
fi

echo "== a fresh Debian in $root"
[ -e "$root/etc/debian_version" ] || debootstrap --variant=minbase bookworm "$root" "$mirror"
rm -rf "$root/try"
mkdir -p "$root/try"
cp build/packages/*.deb samples/glass_16.exr samples/glass_ref.exr "$root/try/"
cp -r tests/packaging/consumer docs/guide/examples/denoise.c "$root/try/"
cp /etc/resolv.conf "$root/etc/resolv.conf"

# Runs a command in the Debian system, with an empty environment: ours may name programs that are not installed there.
inside() {
  chroot "$root" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LC_ALL=C.UTF-8 DEBIAN_FRONTEND=noninteractive \
    ${http_proxy:+http_proxy="$http_proxy"} bash -euc "cd /try; $1"
}

echo "== the program"
inside 'apt-get update -qq; apt-get install -y -qq --no-install-recommends ./polyrecon_*.deb >/dev/null'
inside 'polyrecon --version
  polyrecon denoise -i glass_16.exr -o clean.exr --error-map error.exr --quiet
  polyrecon compare glass_16.exr clean.exr glass_ref.exr
  polyrecon preview clean.exr error.exr -o look.png
  test -s look.png'
echo "== the library"
inside 'apt-get install -y -qq --no-install-recommends g++ cmake ninja-build ./libpolyrecon1_*.deb ./libpolyrecon-dev_*.deb \
    >/dev/null
  rm -rf build; cmake -S consumer -B build -G Ninja >/dev/null; cmake --build build >/dev/null
  build/consumer glass_16.exr theirs.exr
  oiiotool -a --fail 0 --hardfail 0 theirs.exr clean.exr --diff'
echo "== the C library alone"
inside 'dpkg --purge polyrecon libpolyrecon-dev >/dev/null
  apt-get install -y -qq --no-install-recommends ./libpolyrecon1_*.deb ./libpolyrecon-dev_*.deb pkg-config >/dev/null
  cc denoise.c -o denoise $(pkg-config --cflags --libs polyrecon)
  ./denoise glass_16.exr by_c.exr
  oiiotool -a --fail 0 --hardfail 0 by_c.exr theirs.exr --diff'
echo "== removing"
inside 'dpkg --purge libpolyrecon1 libpolyrecon-dev >/dev/null; test ! -e /usr/bin/polyrecon; test ! -e /usr/include/polyrecon'
echo "done: the packages are in build/packages, their results in $root/try"
