#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace polyrecon {

/// The command line as plain data, read from CLI11's tree: what man pages and shell completions are made of.
struct OptionInfo {
  std::vector<std::string> names;  ///< "-o", "--output"; empty for a positional.
  std::string value;               ///< What it takes: "FILE", "draft|standard|best"; empty for a flag.
  std::string help, group;
  bool required = false;

  /// The names that it takes, where they are a closed list.
  std::vector<std::string> choices() const;
  bool takes_file() const;
  bool is_flag() const { return value.empty(); }
};

struct CommandInfo {
  std::string name, summary;
  std::vector<OptionInfo> positionals, options;
  std::string remarks;                      ///< Of the footer: all that stands before "Examples:".
  std::vector<std::string> examples;        ///< A command line each.
  std::vector<CommandInfo> commands;        ///< Empty for a sub-command.
  std::vector<std::string> groups() const;  ///< Of the options, in order of appearance.
};

/// Reads app and, one level deep, its sub-commands.
CommandInfo describe(const CLI::App& app);

}  // namespace polyrecon
