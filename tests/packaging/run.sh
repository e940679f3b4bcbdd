#!/usr/bin/env bash
# Installs the two Debian packages in a fresh Debian 12 and uses them there: a frame is denoised, and a program is built
# against the library. Needs root, debootstrap and the network; takes minutes, so it is no part of tests/run.sh.
#
#     tests/packaging/run.sh [FOLDER]      # FOLDER: where the Debian goes; default build/debian
set -euo pipefail
cd "$(dirname "$0")/../.."
root=$(realpath -m "${1:-build/debian}")
mirror=${DEBIAN_MIRROR:-http://deb.debian.org/debian}

echo "== packages"
cmake --preset release
cmake --build --preset release
rm -rf build/packages
cpack --config build/release/CPackConfig.cmake -G DEB -B build/packages
# Who distributes the packages names a real maintainer by -DCPACK_PACKAGE_CONTACT; the default is a local one.
if command -v lintian >/dev/null; then
  lintian --fail-on error --suppress-tags bogus-mail-host,bogus-mail-host-in-debian-changelog,root-in-contact \
    build/packages/*.deb
fi

echo "== a fresh Debian in $root"
[ -e "$root/etc/debian_version" ] || debootstrap --variant=minbase bookworm "$root" "$mirror"
rm -rf "$root/try"
mkdir -p "$root/try"
cp build/packages/*.deb samples/glass_16.exr samples/glass_ref.exr "$root/try/"
cp -r tests/packaging/consumer "$root/try/"
cp /etc/resolv.conf "$root/etc/resolv.conf"

# oiiotool comes with libpolyrecon-dev, as a dependency.
# Nothing of this environment goes in: it may name tools that are not there, such as a compiler launcher.
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
inside 'apt-get install -y -qq --no-install-recommends g++ cmake ninja-build ./libpolyrecon-dev_*.deb >/dev/null
  rm -rf build; cmake -S consumer -B build -G Ninja >/dev/null; cmake --build build >/dev/null
  build/consumer glass_16.exr theirs.exr
  oiiotool -a --fail 0 --hardfail 0 theirs.exr clean.exr --diff'
echo "== removing"
inside 'dpkg --purge polyrecon libpolyrecon-dev >/dev/null; test ! -e /usr/bin/polyrecon; test ! -e /usr/include/polyrecon'
echo "done: packages in build/packages, what they made in $root/try"
