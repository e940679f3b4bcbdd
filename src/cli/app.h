#pragma once

#include <CLI/CLI.hpp>

#include "cli/commands.h"

namespace polyrecon {

/// The option of the program that makes it check the options of a command, and do nothing else.
constexpr const char* check_options = "--check-options";

/// Adds the whole command line to app: every command with its options, help and examples. Parsing sets `chosen`. Man
/// pages, shell completions and docs/reference/command_line.md are generated from the same tree (src/manual).
void setup_app(CLI::App& app, Command& chosen);

}  // namespace polyrecon
