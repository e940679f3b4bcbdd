# Options of the linker that make a fault in memory harder to use for whoever sends a hostile file: tables of functions
# are read-only before main, no data is executable, and all addresses are random. Users of the library do not get them.
# tests/packaging/hardening_test.py checks the built program.
include(CheckPIESupported)
check_pie_supported(LANGUAGES CXX)  # so that -pie is passed to the linker wherever the compiler does not by itself
add_library(polyrecon_hardening INTERFACE)
target_link_options(polyrecon_hardening INTERFACE LINKER:-z,relro LINKER:-z,now LINKER:-z,noexecstack)
