# Called by libraries.sh: headers of OpenImageIO and OpenColorIO, their libraries from their wheels, and the files by which
# src/polyreconDependencies.cmake finds them. The values are those that the projects' own builds of the wheels have.
cmake_minimum_required(VERSION 3.25)
set(oiio ${PREFIX}/source/openimageio-${OIIO_VERSION})
set(ocio ${PREFIX}/source/opencolorio-${OCIO_VERSION})

string(REPLACE "." ";" parts ${OIIO_VERSION})
list(GET parts 0 PROJECT_VERSION_MAJOR)
list(GET parts 1 PROJECT_VERSION_MINOR)
list(GET parts 2 PROJECT_VERSION_PATCH)
list(GET parts 3 PROJECT_VERSION_TWEAK)
set(OIIO_USE_COMPILED_FMT_VALUE 0)
set(PROJ_NAMESPACE OpenImageIO)
set(PROJ_VERSION_NAMESPACE v${PROJECT_VERSION_MAJOR}_${PROJECT_VERSION_MINOR})
set(Imath_VERSION_MAJOR 3)
set(Imath_VERSION_MINOR 1)
set(CMAKE_CXX_STANDARD 17)
file(COPY ${oiio}/src/include/OpenImageIO DESTINATION ${PREFIX}/include PATTERN "*.in" EXCLUDE)
configure_file(${oiio}/src/include/OpenImageIO/oiioversion.h.in ${PREFIX}/include/OpenImageIO/oiioversion.h @ONLY)
# OpenImageIO's headers expect the copy of fmt's headers that its build makes.
file(COPY /usr/include/fmt DESTINATION ${PREFIX}/include/OpenImageIO/detail)

string(REPLACE "." ";" parts ${OCIO_VERSION})
list(GET parts 0 OpenColorIO_VERSION_MAJOR)
list(GET parts 1 OpenColorIO_VERSION_MINOR)
list(GET parts 2 OpenColorIO_VERSION_PATCH)
set(OpenColorIO_VERSION ${OCIO_VERSION})
set(OCIO_NAMESPACE OpenColorIO_v${OpenColorIO_VERSION_MAJOR}_${OpenColorIO_VERSION_MINOR})
file(COPY ${ocio}/include/OpenColorIO DESTINATION ${PREFIX}/include PATTERN "*.in" EXCLUDE)
configure_file(${ocio}/include/OpenColorIO/OpenColorABI.h.in ${PREFIX}/include/OpenColorIO/OpenColorABI.h @ONLY)

set(oiio_libraries ${PREFIX}/source/openimageio-wheel/OpenImageIO/lib)
set(series ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR}.${PROJECT_VERSION_PATCH})
file(COPY ${oiio_libraries}/libOpenImageIO.so.${series} ${oiio_libraries}/libOpenImageIO_Util.so.${series}
          ${PREFIX}/source/opencolorio-wheel/PyOpenColorIO/libOpenColorIO.so
     DESTINATION ${PREFIX}/lib)
file(WRITE ${PREFIX}/lib/cmake/OpenImageIO/OpenImageIOConfig.cmake "set(OpenImageIO_VERSION ${OIIO_VERSION})
foreach(name OpenImageIO OpenImageIO_Util)
  add_library(OpenImageIO::\${name} SHARED IMPORTED)
  set_target_properties(OpenImageIO::\${name} PROPERTIES
    IMPORTED_LOCATION ${PREFIX}/lib/lib\${name}.so.${series}
    INTERFACE_INCLUDE_DIRECTORIES ${PREFIX}/include)
endforeach()
target_link_libraries(OpenImageIO::OpenImageIO INTERFACE OpenImageIO::OpenImageIO_Util)
")
file(WRITE ${PREFIX}/lib/pkgconfig/OpenColorIO.pc "Name: OpenColorIO
Description: colour management
Version: ${OCIO_VERSION}
Libs: -L${PREFIX}/lib -lOpenColorIO
Cflags: -I${PREFIX}/include
")

# Fonts of captions, and the licences of everything that the wheel holds.
file(COPY ${PREFIX}/source/openimageio-wheel/OpenImageIO/share/fonts DESTINATION ${PREFIX}/share)
set(exr ${PREFIX}/source/openexr-${OPENEXR_VERSION})
set(debian /usr/share/doc)
foreach(pair openexr=${exr}/LICENSE.md openexr-openjph=${exr}/external/OpenJPH/LICENSE
        openexr-libdeflate=${exr}/external/deflate/COPYING openexr-zstd=${exr}/external/zstd/LICENSE
        openimageio=${oiio}/LICENSE.md openimageio-third-party=${oiio}/THIRD-PARTY.md
        opencolorio=${ocio}/LICENSE opencolorio-third-party=${ocio}/THIRD-PARTY.md
        cli11=${debian}/libcli11-dev/copyright eigen=${debian}/libeigen3-dev/copyright fmt=${debian}/libfmt9/copyright
        imath=${debian}/libimath-3-1-29/copyright nlohmann-json=${debian}/nlohmann-json3-dev/copyright
        tbb=${debian}/libtbb12/copyright fonts=${oiio}/src/fonts/Droid_Sans/droid-lic.txt)
  string(REGEX MATCH "([^=]+)=(.*)" ignored ${pair})
  configure_file(${CMAKE_MATCH_2} ${PREFIX}/share/licenses/${CMAKE_MATCH_1}.txt COPYONLY)
endforeach()
