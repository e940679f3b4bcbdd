#include "io/pictures/picture_file.h"

#include <cctype>
#include <filesystem>

#include "io/files/atomic_file.h"
#include "io/pictures/preview.h"

namespace polyrecon {
namespace {

/// OpenImageIO's name of the format that the ending of a path stands for.
std::string format_of(const std::string& path) {
  const std::string ending = std::filesystem::path(path).extension().string();
  const auto letter = ending.size() > 1 ? std::tolower(static_cast<unsigned char>(ending[1])) : 0;
  return letter == 'j' ? "jpeg" : letter == 't' ? "tiff" : "png";
}

}  // namespace

void write_picture(const std::string& target, const Image& rgb) {
  write_bytes(target, encode_picture(rgb, format_of(target)));
}

}  // namespace polyrecon
