# Settings of a build by pip (pyproject.toml). Program and library are installed into the Python package, man pages and
# completions into the share/ of the Python environment.
set(CMAKE_INSTALL_DATADIR ${SKBUILD_DATA_DIR}/share)
install(PROGRAMS src/package/polyrecon_command.py DESTINATION ${SKBUILD_SCRIPTS_DIR} RENAME polyrecon COMPONENT program)
set(POLYRECON_WHEEL_LIBRARIES "" CACHE PATH "Folder that src/package/wheel/libraries.sh has made")
if(POLYRECON_WHEEL_LIBRARIES)
  set(CMAKE_PREFIX_PATH ${POLYRECON_WHEEL_LIBRARIES})
  install(DIRECTORY ${POLYRECON_WHEEL_LIBRARIES}/share/licenses DESTINATION ${SKBUILD_METADATA_DIR} COMPONENT program)
  # OpenImageIO looks for the fonts of captions in share/ next to the program's folder.
  install(DIRECTORY ${POLYRECON_WHEEL_LIBRARIES}/share/fonts DESTINATION share COMPONENT program)
endif()
