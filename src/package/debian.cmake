# Settings of `cpack`, which makes three Debian packages: polyrecon (program, man pages, completions), libpolyrecon1 (shared
# library) and libpolyrecon-dev (headers, static library, CMake package, pkg-config). dpkg-shlibdeps (package dpkg-dev) finds the program's dependencies.
set(documents ${CMAKE_CURRENT_LIST_DIR}/copyright ${CMAKE_CURRENT_LIST_DIR}/changelog)
install(FILES ${documents} DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/polyrecon COMPONENT program)
install(FILES ${documents} DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/libpolyrecon1 COMPONENT runtime)
install(FILES ${documents} DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/libpolyrecon-dev COMPONENT library)

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_CONTACT "polyrecon <root@localhost>" CACHE STRING "Maintainer of the packages that cpack makes")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE
  WORLD_READ WORLD_EXECUTE)
set(CPACK_STRIP_FILES ON)
set(CPACK_PRE_BUILD_SCRIPTS ${CMAKE_CURRENT_LIST_DIR}/debian_layout.cmake)

set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_ALL program runtime library)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)

set(CPACK_DEBIAN_PROGRAM_PACKAGE_NAME polyrecon)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SECTION graphics)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_DEPENDS fonts-dejavu-core)  # the letters in previews
set(CPACK_COMPONENT_PROGRAM_DESCRIPTION "rebuilds clean images from noisy Monte Carlo renders
polyrecon reads a noisy render with its feature passes, fits polynomials to
overlapping windows and blends them. It estimates the error of each pixel and
where a renderer's next samples help most.")

set(CPACK_DEBIAN_RUNTIME_PACKAGE_NAME libpolyrecon1)
set(CPACK_DEBIAN_RUNTIME_PACKAGE_SECTION libs)
set(CPACK_DEBIAN_RUNTIME_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_RUNTIME_PACKAGE_SUGGESTS polyrecon)  # whose module reads pictures other than EXR
# CPack adds scripts that call ldconfig, as Debian had them before triggers, which it requires now.
set(control ${PROJECT_BINARY_DIR}/libpolyrecon1)
file(CONFIGURE OUTPUT ${control}/shlibs CONTENT "libpolyrecon 1 libpolyrecon1 (>= @PROJECT_VERSION@)\n" @ONLY)
file(CONFIGURE OUTPUT ${control}/triggers CONTENT "activate-noawait ldconfig\n")
set(CPACK_DEBIAN_RUNTIME_PACKAGE_CONTROL_EXTRA ${control}/shlibs ${control}/triggers)
set(CPACK_COMPONENT_RUNTIME_DESCRIPTION "rebuilds clean images from noisy Monte Carlo renders (C library)
The library that renderers, compositors and the Python package call to denoise
images in memory.")

set(CPACK_DEBIAN_LIBRARY_PACKAGE_NAME libpolyrecon-dev)
set(CPACK_DEBIAN_LIBRARY_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_LIBRARY_PACKAGE_DEPENDS "libpolyrecon1 (= ${PROJECT_VERSION}), libeigen3-dev, libtbb-dev, \
libopenexr-dev, libopenimageio-dev, openimageio-tools, libopencolorio-dev, libfmt-dev, nlohmann-json3-dev, zlib1g-dev, \
pkg-config")
set(CPACK_COMPONENT_LIBRARY_DESCRIPTION "rebuilds clean images from noisy Monte Carlo renders (development)
The header of the C library, the static library in C++ with its headers, and
the files by which pkg-config and CMake's find_package(polyrecon) find them.")
include(CPack)
