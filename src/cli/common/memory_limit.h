#pragma once

#include <CLI/CLI.hpp>
#include <cstddef>

namespace polyrecon {

/// The limit of a command unless --max-memory sets another: half of the memory that this machine, or the control group
/// of this process, has, but at least 4 GiB.
std::size_t default_memory();

/// The help of --max-memory, and its default in words.
extern const char* const max_memory_help;
extern const char* const default_memory_text;

/// Adds --max-memory for a command that calls limit_memory.
void add_memory_limit(CLI::App& app, std::size_t& bytes);

/// After this call, allocations that would bring the process beyond so many bytes fail with std::bad_alloc. Stacks of
/// threads do not count. `denoise` plans its memory instead (pipeline/memory.h).
void limit_memory(std::size_t bytes);

/// The limit that was set; 0: none.
std::size_t memory_limit();

}  // namespace polyrecon
