#include "core/utf8.h"

#include <algorithm>
#include <array>

namespace polyrecon {
namespace {

struct Range {
  char32_t first, last;
};

// The same characters as in pipelines/common/terminal.py, but for surrogates: here these are no UTF-8.
constexpr std::array<Range, 6> controls{
    {{0, 0x1f}, {0x7f, 0x9f}, {0x61c, 0x61c}, {0x200e, 0x200f}, {0x2028, 0x202e}, {0x2066, 0x2069}}};

/// Bytes of a sequence by its first byte; 0 where no sequence begins with it.
std::size_t sequence_length(unsigned char first) {
  if (first < 0x80) return 1;
  if (first >= 0xc2 && first < 0xe0) return 2;
  if (first >= 0xe0 && first < 0xf0) return 3;
  return first >= 0xf0 && first < 0xf5 ? 4 : 0;
}

}  // namespace

CodePoint code_point_at(std::string_view text, std::size_t at) {
  constexpr std::array<char32_t, 5> least{0, 0, 0x80, 0x800, 0x10000};  // by length; smaller codes are overlong
  const auto first = static_cast<unsigned char>(text[at]);
  const CodePoint invalid{first, 1, false};
  const std::size_t length = sequence_length(first);
  if (length == 0 || at + length > text.size()) return invalid;
  char32_t code = length == 1 ? first : first & (0x7fU >> length);
  for (std::size_t k = 1; k < length; ++k) {
    const auto next = static_cast<unsigned char>(text[at + k]);
    if ((next & 0xc0U) != 0x80) return invalid;
    code = (code << 6) | (next & 0x3fU);
  }
  if (code < least[length] || code > 0x10ffff || (code >= 0xd800 && code < 0xe000)) return invalid;
  return {code, length, true};
}

bool is_control(char32_t code) {
  return std::any_of(controls.begin(), controls.end(),
                     [=](const Range& range) { return code >= range.first && code <= range.last; });
}

}  // namespace polyrecon
