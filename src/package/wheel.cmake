# Settings of a build by pip (pyproject.toml). Program and library are installed into the Python package, man pages and
# completions into the share/ of the Python environment.
set(CMAKE_INSTALL_DATADIR ${SKBUILD_DATA_DIR}/share)
install(PROGRAMS src/package/polyrecon_command.py DESTINATION ${SKBUILD_SCRIPTS_DIR} RENAME polyrecon COMPONENT program)
