# Settings of `cpack`, which makes two Debian packages: polyrecon (program, man pages, completions) and libpolyrecon-dev
# (static library, headers, CMake package). dpkg-shlibdeps (package dpkg-dev) finds the program's dependencies.
set(documents ${CMAKE_CURRENT_LIST_DIR}/copyright ${CMAKE_CURRENT_LIST_DIR}/changelog)
install(FILES ${documents} DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/polyrecon COMPONENT program)
install(FILES ${documents} DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/libpolyrecon-dev COMPONENT library)

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_CONTACT "polyrecon <root@localhost>" CACHE STRING "Maintainer of the packages that cpack makes")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE
  WORLD_READ WORLD_EXECUTE)
set(CPACK_STRIP_FILES ON)
set(CPACK_PRE_BUILD_SCRIPTS ${CMAKE_CURRENT_LIST_DIR}/debian_layout.cmake)

set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_ALL program library)
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

set(CPACK_DEBIAN_LIBRARY_PACKAGE_NAME libpolyrecon-dev)
set(CPACK_DEBIAN_LIBRARY_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_LIBRARY_PACKAGE_DEPENDS "libeigen3-dev, libtbb-dev, libopenexr-dev, libopenimageio-dev, \
openimageio-tools, libopencolorio-dev, libfmt-dev, nlohmann-json3-dev, zlib1g-dev, pkg-config")
set(CPACK_COMPONENT_LIBRARY_DESCRIPTION "rebuilds clean images from noisy Monte Carlo renders (library)
The static library behind polyrecon, its headers, and the files by which
CMake's find_package(polyrecon) finds them.")
include(CPack)
