#pragma once

#include <string>

#include "manual/command_line.h"

namespace polyrecon {

/// Completion scripts for three shells. They complete commands, options, values of options that take one of a few
/// names, and file names.
std::string bash_completion(const CommandInfo& program);
std::string zsh_completion(const CommandInfo& program);
std::string fish_completion(const CommandInfo& program);

}  // namespace polyrecon
