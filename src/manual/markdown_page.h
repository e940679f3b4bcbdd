#pragma once

#include <string>

#include "manual/command_line.h"

namespace polyrecon {

/// The page docs/reference/command_line.md: the commands, and each command's options by group.
std::string markdown_page(const CommandInfo& program);

}  // namespace polyrecon
