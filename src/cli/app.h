#pragma once

#include <CLI/CLI.hpp>

#include "cli/commands.h"

namespace polyrecon {

/// Gives app the whole command line: every sub-command with its options, help and examples. Parsing it sets chosen.
/// The man pages and shell completions are made from the same tree (src/manual).
void setup_app(CLI::App& app, Command& chosen);

}  // namespace polyrecon
