# Options that make a fault in memory harder to use for whoever sends a hostile file: stacks and copies are checked, jumps
# end at marked places, tables of functions are read-only before main, no data is executable, and all addresses are
# random. Users of the library do not get them. tests/packaging/hardening_test.py checks the built files.
include(CheckCXXCompilerFlag)
include(CheckPIESupported)
check_pie_supported(LANGUAGES CXX)  # so that -pie is passed to the linker wherever the compiler does not by itself
check_cxx_compiler_flag(-fcf-protection=full POLYRECON_HAS_CF_PROTECTION)  # x86 alone

# The checked copies need an optimised build, and hide from a sanitizer what it looks for.
string(TOUPPER "${CMAKE_BUILD_TYPE}" build_type)
set(POLYRECON_FORTIFY OFF)
if(build_type MATCHES "^(RELEASE|RELWITHDEBINFO|MINSIZEREL)$"
    AND NOT "${CMAKE_CXX_FLAGS} ${CMAKE_CXX_FLAGS_${build_type}}" MATCHES "-fsanitize")
  set(POLYRECON_FORTIFY ON)
endif()

add_library(polyrecon_hardening INTERFACE)
target_compile_options(polyrecon_hardening INTERFACE -fstack-protector-strong
  $<$<BOOL:${POLYRECON_HAS_CF_PROTECTION}>:-fcf-protection=full>
  $<$<BOOL:${POLYRECON_FORTIFY}>:-U_FORTIFY_SOURCE> $<$<BOOL:${POLYRECON_FORTIFY}>:-D_FORTIFY_SOURCE=2>)
target_link_options(polyrecon_hardening INTERFACE LINKER:-z,relro LINKER:-z,now LINKER:-z,noexecstack)
