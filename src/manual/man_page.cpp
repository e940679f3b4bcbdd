#include "manual/man_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <sstream>

namespace polyrecon {
namespace {

/// Escapes text for roff, in which "\" and "-" have a meaning, and a dot or a quote at the beginning of a line.
std::string escape(const std::string& text) {
  std::string out;
  for (const char c : text) {
    const bool line_begins = out.empty() || out.back() == '\n';
    if (line_begins && (c == '.' || c == '\'')) out += "\\&";
    if (c == '\\')
      out += "\\e";
    else if (c == '-')
      out += "\\-";
    else
      out += c;
  }
  return out;
}

std::string bold(const std::string& text) { return "\\fB" + escape(text) + "\\fR"; }
std::string italic(const std::string& text) { return "\\fI" + escape(text) + "\\fR"; }

std::string upper(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  return text;
}

std::string title(const std::string& page, const std::string& version) {
  return fmt::format(".TH \"{}\" 1 \"\" \"polyrecon {}\" \"User Commands\"\n", escape(upper(page)), version);
}

std::string section(const std::string& name) { return fmt::format(".SH {}\n", name); }

/// "-o, --output FILE", then the help, indented.
std::string text_of(const OptionInfo& option) {
  std::string head;
  for (const std::string& name : option.names) head += (head.empty() ? "" : ", ") + bold(name);
  if (!option.is_flag()) head += (head.empty() ? "" : " ") + italic(option.value);
  return fmt::format(".TP\n{}\n{}{}\n", head, escape(option.help), option.required ? " (required)" : "");
}

std::string options_of(const CommandInfo& command) {
  std::string text = section("OPTIONS");
  for (const OptionInfo& option : command.positionals) text += text_of(option);
  for (const std::string& group : command.groups()) {
    if (group != "Options") text += fmt::format(".SS {}\n", escape(group));
    for (const OptionInfo& option : command.options)
      if (option.group == group) text += text_of(option);
  }
  return text;
}

std::string literal(const std::string& text) { return ".nf\n" + escape(text) + ".fi\n"; }

/// Plain lines become filled paragraphs; indented lines, which are lists, stay lines.
std::string remarks_of(const CommandInfo& command) {
  std::string text, list;
  std::istringstream lines(command.remarks);
  for (std::string line; std::getline(lines, line);) {
    const bool indented = line.compare(0, 2, "  ") == 0;
    if (indented) list += line.substr(2) + "\n";
    if (!indented && !list.empty()) text += literal(list), list.clear();
    if (!indented) text += escape(line) + "\n";
  }
  if (!list.empty()) text += ".PP\n" + literal(list);
  return text;
}

std::string examples_of(const CommandInfo& command) {
  std::string lines;
  for (const std::string& example : command.examples) lines += example + "\n";
  return section("EXAMPLES") + literal(lines);
}

std::string synopsis_of(const CommandInfo& program, const CommandInfo& command) {
  std::string text = fmt::format("{} {}", bold(program.name), bold(command.name));
  for (const OptionInfo& option : command.options)
    if (option.required) text += fmt::format(" {} {}", bold(option.names.front()), italic(option.value));
  text += " [" + italic("OPTIONS") + "]";
  for (const OptionInfo& option : command.positionals) text += " " + italic(option.value);
  return section("SYNOPSIS") + text + "\n";
}

}  // namespace

std::string program_page(const CommandInfo& program, const std::string& version) {
  std::string text = title(program.name, version) + section("NAME");
  text += fmt::format("{} \\- {}\n", escape(program.name), escape(program.summary));
  text += section("SYNOPSIS") + fmt::format("{} {} [{}]\n", bold(program.name), italic("COMMAND"), italic("OPTIONS"));
  text += section("COMMANDS");
  for (const CommandInfo& command : program.commands)
    text += fmt::format(".TP\n{}(1)\n{}\n", bold(program.name + "-" + command.name), escape(command.summary));
  return text + options_of(program) + section("NOTES") + remarks_of(program) + examples_of(program);
}

std::string command_page(const CommandInfo& program, const CommandInfo& command, const std::string& version) {
  const std::string page = program.name + "-" + command.name;
  std::string text = title(page, version) + section("NAME");
  text += fmt::format("{} \\- {}\n", escape(page), escape(command.summary)) + synopsis_of(program, command);
  text += options_of(command);
  if (!command.remarks.empty()) text += section("NOTES") + remarks_of(command);
  text += examples_of(command) + section("SEE ALSO");
  return text + fmt::format("{}(1), which lists the exit codes\n", bold(program.name));
}

}  // namespace polyrecon
