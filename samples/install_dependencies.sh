#!/usr/bin/env bash
# Installs the missing Debian packages for the build and, with --tests, for the tests.
set -euo pipefail
# libopenimageio-dev's CMake files require the programs of openimageio-tools; previews draw captions with the font.
packages=(g++ cmake ninja-build pkg-config libopenimageio-dev openimageio-tools libopenexr-dev libopencolorio-dev
  libcli11-dev libtbb-dev libeigen3-dev nlohmann-json3-dev libfmt-dev zlib1g-dev fonts-dejavu-core)
[ "${1-}" != --tests ] || packages+=(libgtest-dev libgmock-dev libbenchmark-dev clang-format clang-tidy
  python3 python3-numpy python3-openimageio python3-jinja2 python3-rich python3-venv blender povray
  python3-yaml slurm-wlm munge dpkg-dev mandoc zsh fish chromium chromium-driver firefox-esr xvfb)
missing=()
for package in "${packages[@]}"; do
  dpkg-query -W -f='${Status}' "$package" 2>/dev/null | grep -q 'ok installed' || missing+=("$package")
done
[ ${#missing[@]} -gt 0 ] || exit 0
echo "installing ${missing[*]}"
sudo=$([ "$(id -u)" -eq 0 ] || echo sudo)
$sudo apt-get update -qq
DEBIAN_FRONTEND=noninteractive $sudo apt-get install -y -qq --no-install-recommends "${missing[@]}" >/dev/null
