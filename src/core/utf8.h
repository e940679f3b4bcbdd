#pragma once

#include <cstddef>
#include <string_view>

namespace polyrecon {

/// A character of a text.
struct CodePoint {
  char32_t code = 0;  ///< The value of the first byte if the bytes are not UTF-8.
  std::size_t bytes = 1;
  bool valid = false;
};

/// Decodes the character that begins at text[at]. Overlong forms, surrogates and codes above U+10FFFF are no UTF-8.
CodePoint code_point_at(std::string_view text, std::size_t at);

/// Whether a terminal or a browser would act on the character: control characters (C0, DEL, C1), line and paragraph
/// separators, marks that change the direction of text.
bool is_control(char32_t code);

}  // namespace polyrecon
