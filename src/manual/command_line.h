#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace polyrecon {

/// The command line as plain data, read from CLI11's tree. Man pages, shell completions and the reference page are
/// generated from it.
struct OptionInfo {
  std::vector<std::string> names;  ///< "-o", "--output"; empty for a positional.
  std::string value;               ///< Its type: "FILE", "draft|standard|best"; empty for a flag.
  std::string help, group;
  bool required = false;

  /// The names that it takes, if there are a few; else empty.
  std::vector<std::string> choices() const;
  bool takes_file() const;
  bool is_flag() const { return value.empty(); }
};

struct CommandInfo {
  std::string name, summary;
  std::vector<OptionInfo> positionals, options;
  std::string remarks;                      ///< The footer without its examples.
  std::vector<std::string> examples;        ///< One command line each.
  std::vector<CommandInfo> commands;        ///< Empty for a command.
  std::vector<std::string> groups() const;  ///< The groups of the options, in their order.
};

/// Describes app and its commands. Hidden options are left out.
CommandInfo describe(const CLI::App& app);

}  // namespace polyrecon
