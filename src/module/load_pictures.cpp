// The functions that need libOpenImageIO, as the program contains them: the first call loads the module that has the
// real ones. That library depends on some 200 others; linking them takes ten times as long as the rest of the program's
// start.

#include <dlfcn.h>
#include <fmt/format.h>
#include <sys/auxv.h>

#include <filesystem>

#include "module/picture_functions.h"
#include "polyrecon/error.h"

namespace polyrecon {
namespace {

/// The module has a fixed place relative to the program, so that both can be moved together. The program's path is not
/// taken from /proc/self/exe, because /proc may not be mounted.
std::string module_path() {
  // NOLINTNEXTLINE(performance-no-int-to-ptr): the system returns the address as a number
  const auto* program = reinterpret_cast<const char*>(::getauxval(AT_EXECFN));
  const auto folder = std::filesystem::canonical(program).parent_path();
  return (folder / POLYRECON_PICTURES).lexically_normal().string();
}

const PictureFunctions& load() {
  void* module = ::dlopen(module_path().c_str(), RTLD_NOW | RTLD_LOCAL);
  const void* functions = module ? ::dlsym(module, "polyrecon_picture_functions") : nullptr;
  if (!functions)
    throw Error(ExitCode::Missing,
                fmt::format("the module for pictures and input other than EXR cannot be loaded ({})", ::dlerror()));
  return *static_cast<const PictureFunctions*>(functions);
}

const PictureFunctions& loaded() {
  static const PictureFunctions& functions = load();
  return functions;
}

}  // namespace

Image false_color(const Image& values, const LogRange& range) { return loaded().false_color(values, range); }

Image flip_color(const Image& values) { return loaded().flip_color(values); }

void describe_plain_image(FileInfo& file, const ReadLimits& limits) { loaded().describe_plain_image(file, limits); }

Image read_plain_image(const FileInfo& file, const std::vector<std::string>& channels) {
  return loaded().read_plain_image(file, channels);
}

Image compose(const std::vector<Panel>& panels) { return loaded().compose(panels); }

Image stack(const std::vector<Image>& rows) { return loaded().stack(rows); }

bool has_font() { return loaded().has_font(); }

std::string encode_png(const Image& rgb) { return loaded().encode_png(rgb); }

}  // namespace polyrecon
