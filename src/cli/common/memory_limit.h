#pragma once

#include <CLI/CLI.hpp>
#include <cstddef>

namespace polyrecon {

/// The limit of a command unless --max-memory sets another.
constexpr std::size_t default_memory = std::size_t{4} << 30;

/// Adds --max-memory for a command that calls limit_memory.
void add_memory_limit(CLI::App& app, std::size_t& bytes);

/// After this call, allocations that would bring the process beyond so many bytes fail with std::bad_alloc. Stacks of
/// threads do not count. `denoise` plans its memory instead (pipeline/memory.h).
void limit_memory(std::size_t bytes);

/// The limit that was set; 0: none.
std::size_t memory_limit();

}  // namespace polyrecon
