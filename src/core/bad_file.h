#pragma once

#include <fmt/format.h>

#include <string>

#include "polyrecon/error.h"

namespace polyrecon {

/// Throws Error{BadInput}: "PATH: WHAT".
[[noreturn]] inline void refuse_file(const std::string& path, const std::string& what) {
  throw Error(ExitCode::BadInput, fmt::format("{}: {}", path, what));
}

}  // namespace polyrecon
