// The functions that need libOpenImageIO, as the program contains them: the first call loads the module that has the
// real ones. That library depends on some 200 others; linking them takes ten times as long as the rest of the program's
// start.

#include <dlfcn.h>
#include <fmt/format.h>

#include <string>

#include "module/module_folder.h"
#include "module/picture_functions.h"
#include "polyrecon/error.h"

namespace polyrecon {
namespace {

const PictureFunctions& load() {
  const std::string path = (module_folder() / POLYRECON_PICTURES).lexically_normal().string();
  void* module = ::dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
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

std::string encode_picture(const Image& rgb, const std::string& format) { return loaded().encode_picture(rgb, format); }

}  // namespace polyrecon
