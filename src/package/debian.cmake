# Settings of `cpack`, which makes three Debian packages: polyrecon (program, man pages, completions), libpolyrecon1 (shared
# library) and libpolyrecon-dev (headers, static library, CMake package, pkg-config). dpkg-shlibdeps (package dpkg-dev) finds the program's dependencies.
set(nobody "polyrecon <root@localhost>")
set(CPACK_PACKAGE_CONTACT ${nobody} CACHE STRING "Maintainer of the packages that cpack makes")
set(package_folder ${PROJECT_BINARY_DIR}/debian)
configure_file(${CMAKE_CURRENT_LIST_DIR}/changelog ${package_folder}/changelog @ONLY)
foreach(pair program:polyrecon runtime:libpolyrecon1 library:libpolyrecon-dev)
  string(REGEX MATCH "(.*):(.*)" pair ${pair})
  set(component ${CMAKE_MATCH_1})
  set(package ${CMAKE_MATCH_2})
  install(FILES ${CMAKE_CURRENT_LIST_DIR}/copyright ${package_folder}/changelog
    DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${package} COMPONENT ${component})
  # What lintian finds without being a fault, each with the reason.
  set(overrides "")
  if(CPACK_PACKAGE_CONTACT STREQUAL nobody)
    string(APPEND overrides "# Who distributes the package sets the maintainer; this one was built without.\n"
      "${package}: bogus-mail-host *\n${package}: bogus-mail-host-in-debian-changelog *\n${package}: root-in-contact *\n")
  endif()
  if(component STREQUAL "runtime")
    string(APPEND overrides "# CPack writes these scripts for every shared library; the trigger does the same once more.\n"
      "${package}: maintscript-calls-ldconfig *\n")
  endif()
  if(overrides)
    file(WRITE ${package_folder}/${package} "${overrides}")
    install(FILES ${package_folder}/${package} DESTINATION ${CMAKE_INSTALL_DATADIR}/lintian/overrides COMPONENT ${component})
  endif()
endforeach()

set(CPACK_GENERATOR DEB)
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
set(control ${package_folder}/control)
file(CONFIGURE OUTPUT ${control}/shlibs CONTENT "libpolyrecon 1 libpolyrecon1 (>= @PROJECT_VERSION@)\n" @ONLY)
file(CONFIGURE OUTPUT ${control}/triggers CONTENT "activate-noawait ldconfig\n")
# All symbols are those of the first version; a later one adds lines with its own.
file(STRINGS src/c_api/libpolyrecon.map names REGEX "^ +polyrecon_.*;")
list(TRANSFORM names REPLACE " +(.*);" " \\1@POLYRECON_1.0 0.1.0\n")
list(PREPEND names "libpolyrecon.so.1 libpolyrecon1 #MINVER#\n* Build-Depends-Package: libpolyrecon-dev\n" " POLYRECON_1.0@POLYRECON_1.0 0.1.0\n")
string(JOIN "" symbols ${names})
file(CONFIGURE OUTPUT ${control}/symbols CONTENT "${symbols}")
set(CPACK_DEBIAN_RUNTIME_PACKAGE_CONTROL_EXTRA ${control}/shlibs ${control}/symbols ${control}/triggers)
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
