#include "cli/common/encoding_options.h"

#include "cli/common/numbers.h"
#include "io/exr/compression.h"
#include "polyrecon/error.h"

namespace polyrecon {
namespace {

const Choices<Compression>& compressions() {
  static const Choices<Compression> names = [] {
    Choices<Compression> out;
    for (int number = 0; number <= static_cast<int>(Compression::Dwab); ++number)
      out.emplace_back(compression_name(number), static_cast<Compression>(number));
    return out;
  }();
  return names;
}

}  // namespace

void add_encoding_options(OptionSet& set, Encoding& encoding, const std::string& by_default) {
  set.add_choice(
      Changes::Result, "--compression", encoding.compression, compressions(),
      "Compression of the output; pxr24 and those after it lose a little, of colours only; default: " + by_default);
  set.add(Changes::Result, "--dwa-level", encoding.dwa_level,
          "Loss of --compression dwaa and dwab: higher makes smaller files")
      ->check(zero_or_more())
      ->capture_default_str()
      ->type_name("L");
}

void check_encoding(const Encoding& encoding) {
  const bool has_level = encoding.compression == Compression::Dwaa || encoding.compression == Compression::Dwab;
  if (!has_level && encoding.dwa_level != default_dwa_level)
    throw Error(ExitCode::Usage, "--dwa-level needs --compression dwaa or dwab");
}

}  // namespace polyrecon
