#pragma once

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <string>
#include <utility>

// Text that the program prints. Names in files may hold any bytes; they cannot begin a line of their own on a terminal,
// move its cursor, or make JSON that nobody can read.
namespace polyrecon {

/// The text on one line: control characters, and bytes that are not UTF-8, are written as escapes such as \x1b.
std::string printable(const std::string& text);

/// One printable line.
template <typename... T>
std::string text_line(fmt::format_string<T...> format, T&&... arguments) {
  return printable(fmt::format(format, std::forward<T>(arguments)...)) + "\n";
}

/// JSON on one line, or with two blanks a level; what is not UTF-8 becomes U+FFFD.
std::string json_line(const nlohmann::ordered_json& value);
std::string json_text(const nlohmann::ordered_json& value);

}  // namespace polyrecon
