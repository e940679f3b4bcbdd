#pragma once

#include <string>

#include "manual/command_line.h"

namespace polyrecon {

/// The page polyrecon.1 of the program: its commands and exit codes.
std::string program_page(const CommandInfo& program, const std::string& version);

/// The page polyrecon-COMMAND.1 of one of its commands.
std::string command_page(const CommandInfo& program, const CommandInfo& command, const std::string& version);

}  // namespace polyrecon
