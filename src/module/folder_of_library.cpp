#include <dlfcn.h>

#include "module/module_folder.h"

namespace polyrecon {

std::filesystem::path module_folder() {
  Dl_info library{};
  ::dladdr(reinterpret_cast<const void*>(&module_folder), &library);
  return std::filesystem::canonical(library.dli_fname).parent_path() / "polyrecon";
}

}  // namespace polyrecon
