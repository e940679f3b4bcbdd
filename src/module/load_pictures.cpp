// The functions that need libOpenImageIO, as the program has them: the first call loads the module where they are. That
// library brings some 200 others, whose linking would take ten times as long as the rest of the program's start.

#include <dlfcn.h>
#include <fmt/format.h>
#include <sys/auxv.h>

#include <filesystem>

#include "module/picture_functions.h"
#include "polyrecon/error.h"

namespace polyrecon {
namespace {

/// Where the module is, as seen from the program, is fixed; both may be moved together. (/proc/self/exe says nothing
/// where /proc is not mounted.)
std::string module_path() {
  // NOLINTNEXTLINE(performance-no-int-to-ptr): the system tells the address as a number
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
