#include "manual/markdown_page.h"

#include <fmt/format.h>

#include <sstream>
#include <string_view>

namespace polyrecon {
namespace {

/// Escapes text for Markdown, also for the cells of a table.
std::string escape(const std::string& text) {
  constexpr std::string_view special = "\\`*_<[|";
  std::string out;
  for (const char c : text) {
    if (special.find(c) != std::string_view::npos) out += '\\';
    out += c;
  }
  return out;
}

/// A code span. "|" is escaped because it ends the cell of a table even there.
std::string code(const std::string& text) {
  std::string out = "`";
  for (const char c : text) {
    if (c == '|') out += '\\';
    out += c;
  }
  return out + "`";
}

/// "`-o`, `--output` `FILE`".
std::string head_of(const OptionInfo& option) {
  std::string text;
  for (const std::string& name : option.names) text += (text.empty() ? "" : ", ") + code(name);
  if (!option.is_flag()) text += (text.empty() ? "" : " ") + code(option.value);
  return text;
}

std::string row_of(const OptionInfo& option) {
  return fmt::format("| {} | {}{} |\n", head_of(option), escape(option.help), option.required ? " (required)" : "");
}

std::string options_of(const CommandInfo& command) {
  const std::string header = "| option | meaning |\n|---|---|\n";
  std::string text;
  for (const OptionInfo& option : command.positionals) text += row_of(option);
  for (const std::string& group : command.groups()) {
    if (group != "Options") text += fmt::format("\n### {}\n\n", group);
    if (text.empty() || group != "Options") text += header;
    for (const OptionInfo& option : command.options)
      if (option.group == group) text += row_of(option);
  }
  return command.positionals.empty() ? text : header + text;
}

/// Indented lines, which are lists, become a code block; the others a paragraph.
std::string remarks_of(const CommandInfo& command) {
  std::string text;
  bool in_list = false;
  std::istringstream lines(command.remarks);
  for (std::string line; std::getline(lines, line);) {
    const bool indented = line.compare(0, 2, "  ") == 0;
    if (indented != in_list) text += "\n";
    text += indented ? "  " + line + "\n" : escape(line) + "\n";
    in_list = indented;
  }
  return text.empty() ? text : "\n" + text;
}

std::string examples_of(const CommandInfo& command) {
  std::string text;
  for (const std::string& example : command.examples) text += "    " + example + "\n";
  return text.empty() ? text : "\nExamples:\n\n" + text;
}

/// "polyrecon denoise -i FILE -o FILE [OPTIONS]".
std::string synopsis_of(const CommandInfo& program, const CommandInfo& command) {
  std::string text = fmt::format("    {} {}", program.name, command.name);
  for (const OptionInfo& option : command.options)
    if (option.required) text += fmt::format(" {} {}", option.names.front(), option.value);
  text += " [OPTIONS]";
  for (const OptionInfo& option : command.positionals) text += " " + option.value;
  return text + "\n";
}

std::string section_of(const CommandInfo& program, const CommandInfo& command) {
  return fmt::format("\n## {} {}\n\n{}.\n\n{}\n{}{}{}", program.name, command.name, escape(command.summary),
                     synopsis_of(program, command), options_of(command), remarks_of(command), examples_of(command));
}

}  // namespace

std::string markdown_page(const CommandInfo& program) {
  std::string text = fmt::format(
      "# Command line\n\n"
      "<!-- Written by `cmake --build --preset dev --target command_line_page`; edit the options in src/cli instead. "
      "-->\n\n"
      "{}\nThis page says what `{} COMMAND --help` says.\n\n"
      "    {} COMMAND [OPTIONS]\n\n"
      "| command | what it does |\n|---|---|\n",
      escape(program.summary), program.name, program.name);
  for (const CommandInfo& command : program.commands)
    text += fmt::format("| [{0}](#{1}-{0}) | {2} |\n", command.name, program.name, escape(command.summary));
  text += "\n" + options_of(program) + remarks_of(program) + examples_of(program);
  for (const CommandInfo& command : program.commands) text += section_of(program, command);
  return text;
}

}  // namespace polyrecon
