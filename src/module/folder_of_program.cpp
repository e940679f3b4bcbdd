#include <sys/auxv.h>

#include "module/module_folder.h"

namespace polyrecon {

/// The program's path is not taken from /proc/self/exe, because /proc may not be mounted.
std::filesystem::path module_folder() {
  // NOLINTNEXTLINE(performance-no-int-to-ptr): the system returns the address as a number
  const auto* program = reinterpret_cast<const char*>(::getauxval(AT_EXECFN));
  return std::filesystem::canonical(program).parent_path() / POLYRECON_MODULES;
}

}  // namespace polyrecon
