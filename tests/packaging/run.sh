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
cmake --preset release
cmake --build --preset release
rm -rf build/packages
cpack --config build/release/CPackConfig.cmake -G DEB -B build/packages
# Set a real maintainer with -DCPACK_PACKAGE_CONTACT before you distribute packages; lintian warns of the default.
if command -v lintian >/dev/null; then
  lintian --fail-on error --suppress-tags bogus-mail-host,bogus-mail-host-in-debian-changelog,root-in-contact \
    build/packages/*.deb
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
