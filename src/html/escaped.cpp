#include "html/escaped.h"

#include <cstddef>
#include <string_view>

#include "core/utf8.h"

namespace polyrecon {
namespace {

/// The entity for a character with a meaning in HTML; empty for others.
std::string_view entity_of(char32_t code) {
  switch (code) {
    case '&':
      return "&amp;";
    case '<':
      return "&lt;";
    case '>':
      return "&gt;";
    case '"':
      return "&quot;";
    case '\'':
      return "&#39;";
    default:
      return {};
  }
}

}  // namespace

std::string escaped(const std::string& text) {
  std::string out;
  for (std::size_t at = 0; at < text.size();) {
    const CodePoint point = code_point_at(text, at);
    const bool shown = point.valid && (!is_control(point.code) || point.code == '\n');
    const std::string_view entity = shown ? entity_of(point.code) : "&#xfffd;";
    entity.empty() ? out.append(text, at, point.bytes) : out.append(entity);
    at += point.bytes;
  }
  return out;
}

}  // namespace polyrecon
