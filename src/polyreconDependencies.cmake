# The libraries that polyrecon is built on. The installed CMake package includes this file too, as users of the static
# library link them.
find_package(Eigen3 REQUIRED)
find_package(TBB REQUIRED)
find_package(OpenEXR CONFIG REQUIRED)
find_package(OpenImageIO REQUIRED)
find_package(PkgConfig REQUIRED)
pkg_check_modules(OpenColorIO REQUIRED IMPORTED_TARGET OpenColorIO)  # Debian ships no CMake package of it
find_package(fmt CONFIG REQUIRED)
find_package(nlohmann_json CONFIG REQUIRED)
find_package(ZLIB REQUIRED)

# Debian's OpenImageIO target names the include folder of OpenCV even if that is not installed, which would be an error.
# OpenImageIO's headers do not need it.
get_target_property(oiio_includes OpenImageIO::OpenImageIO INTERFACE_INCLUDE_DIRECTORIES)
set(existing_includes "")
foreach(folder IN LISTS oiio_includes)
  if(EXISTS "${folder}")
    list(APPEND existing_includes "${folder}")
  endif()
endforeach()
set_target_properties(OpenImageIO::OpenImageIO PROPERTIES INTERFACE_INCLUDE_DIRECTORIES "${existing_includes}")
