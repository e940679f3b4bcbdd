#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "cli/commands.h"

namespace polyrecon {

/// Parses the words behind the program's name. Its command does nothing after --help and --version, which are
/// answered, and after --check-options, whose check was made. `help COMMAND` is `COMMAND --help`, and a path where a
/// command is expected is `denoise -i PATH`. Throws Error{Usage}, which suggests the nearest name for a mistyped one.
Command parse_command_line(const std::vector<std::string>& words);

}  // namespace polyrecon
