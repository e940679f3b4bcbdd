#pragma once

#include <string>

#include "manual/command_line.h"

namespace polyrecon {

/// Completion scripts: the commands, the options of each, the values of options that take one of a few names, and file
/// names where a file is asked for.
std::string bash_completion(const CommandInfo& program);
std::string zsh_completion(const CommandInfo& program);
std::string fish_completion(const CommandInfo& program);

}  // namespace polyrecon
