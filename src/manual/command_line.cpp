#include "manual/command_line.h"

#include <algorithm>
#include <cctype>
#include <sstream>

namespace polyrecon {
namespace {

OptionInfo describe(const CLI::Option& option) {
  OptionInfo info;
  for (const std::string& name : option.get_snames()) info.names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) info.names.push_back("--" + name);
  if (option.get_items_expected_max() > 0) info.value = option.get_type_name();
  info.help = option.get_description();
  info.group = option.get_group();
  info.required = option.get_required();
  if (!info.is_flag() && !option.get_default_str().empty()) info.help += " (default " + option.get_default_str() + ")";
  return info;
}

/// Indented lines below "Examples:" are examples; all other lines are remarks.
void split_footer(const std::string& footer, CommandInfo& info) {
  std::istringstream lines(footer);
  bool examples = false;
  for (std::string line; std::getline(lines, line);) {
    if (line == "Examples:")
      examples = true;
    else if (examples && line.compare(0, 2, "  ") == 0)
      info.examples.push_back(line.substr(2));
    else
      info.remarks += line + "\n";
  }
}

/// Whether a word of an option's type stands for something to type: "FILE" in "LAYER|FILE".
bool is_placeholder(const std::string& word) {
  const auto is = [&](int (*kind)(int)) {
    return std::any_of(word.begin(), word.end(), [&](unsigned char c) { return kind(c) != 0; });
  };
  return is(std::isupper) && !is(std::islower);
}

}  // namespace

std::vector<std::string> OptionInfo::choices() const {
  std::vector<std::string> found;
  if (value.find('|') == std::string::npos) return found;
  std::istringstream text(value);
  for (std::string name; std::getline(text, name, '|');)
    if (!is_placeholder(name)) found.push_back(name);
  return found;
}

bool OptionInfo::takes_file() const {
  return value.find("FILE") != std::string::npos || value.find("IMAGE") != std::string::npos;
}

std::vector<std::string> CommandInfo::groups() const {
  std::vector<std::string> found;
  for (const OptionInfo& option : options)
    if (std::find(found.begin(), found.end(), option.group) == found.end()) found.push_back(option.group);
  return found;
}

CommandInfo describe(const CLI::App& app) {
  CommandInfo info;
  info.name = app.get_name();
  info.summary = app.get_description();
  split_footer(app.get_footer(), info);
  for (const CLI::Option* option : app.get_options()) {
    if (option->get_group().empty()) continue;  // hidden
    (option->get_positional() ? info.positionals : info.options).push_back(describe(*option));
  }
  for (const CLI::App* sub : app.get_subcommands(nullptr)) info.commands.push_back(describe(*sub));
  return info;
}

}  // namespace polyrecon
