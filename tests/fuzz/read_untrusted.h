#pragma once

#include <string>

namespace polyrecon::fuzz {

/// Handles an untrusted file as the program would: inspects it, reads it, writes it with its beauty replaced, and
/// merges it with a copy of itself. Outputs go to folder. The memory limit is 512 MiB. An Error is an expected outcome,
/// except ExitCode::Internal; that one and all other exceptions are passed on.
void read_untrusted(const std::string& path, const std::string& folder);

}  // namespace polyrecon::fuzz
