#include "cli/common/printed_text.h"

#include "core/utf8.h"

namespace polyrecon {
namespace {

std::string escape(char32_t code) {
  switch (code) {
    case '\n':
      return "\\n";
    case '\r':
      return "\\r";
    case '\t':
      return "\\t";
    default:
      break;
  }
  const auto number = static_cast<unsigned>(code);
  return code < 0x100 ? fmt::format("\\x{:02x}", number) : fmt::format("\\u{:04x}", number);
}

/// JSON escapes the controls of ASCII by itself. The others may stand in a string, but a terminal acts on them.
std::string dump(const nlohmann::ordered_json& value, int indent) {
  const std::string text = value.dump(indent, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
  std::string out;
  out.reserve(text.size());
  for (std::size_t at = 0; at < text.size();) {
    const CodePoint point = code_point_at(text, at);
    if (point.code > 0x7e && is_control(point.code))
      out += fmt::format("\\u{:04x}", static_cast<unsigned>(point.code));
    else
      out.append(text, at, point.bytes);
    at += point.bytes;
  }
  return out;
}

}  // namespace

std::string printable(const std::string& text) {
  std::string out;
  for (std::size_t at = 0; at < text.size();) {
    const CodePoint point = code_point_at(text, at);
    if (point.valid && !is_control(point.code))
      out.append(text, at, point.bytes);
    else
      out += escape(point.code);
    at += point.bytes;
  }
  return out;
}

std::string json_line(const nlohmann::ordered_json& value) { return dump(value, -1); }

std::string json_text(const nlohmann::ordered_json& value) { return dump(value, 2) + "\n"; }

}  // namespace polyrecon
