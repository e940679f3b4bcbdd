#include "io/exr/compression.h"

#include <OpenEXR/ImfCompression.h>
#include <OpenEXR/OpenEXRConfig.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>

namespace polyrecon {
namespace {

std::string upper_case(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  return text;
}

}  // namespace

std::string compression_name(int number) {
  // HTJ2K (blocks of 256 and of 32 lines) is of OpenEXR 3.4, the last two are of 3.5.
  static constexpr std::array names{"none", "rle",  "zips", "zip",   "piz",   "pxr24", "b44",
                                    "b44a", "dwaa", "dwab", "htj2k", "htj2k", "lj2k",  "zstd"};
  const auto index = static_cast<std::size_t>(number);
  return number >= 0 && index < names.size() ? names[index] : "";
}

std::optional<Compression> compression_from(const std::string& name) {
  for (int number = 0; number <= static_cast<int>(Compression::Dwab); ++number)
    if (compression_name(number) == name) return static_cast<Compression>(number);
  return std::nullopt;
}

std::string compression_obstacle(int number) {
  const std::string name = compression_name(number);
  if (name.empty() || number < Imf::NUM_COMPRESSION_METHODS) return {};
  return fmt::format("compressed by {}, which OpenEXR {}.{} of this build cannot read; save as ZIP", upper_case(name),
                     OPENEXR_VERSION_MAJOR, OPENEXR_VERSION_MINOR);
}

}  // namespace polyrecon
