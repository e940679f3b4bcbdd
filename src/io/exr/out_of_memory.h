#pragma once

#include <exception>
#include <new>
#include <string_view>

namespace polyrecon {

/// Throws std::bad_alloc where an exception of OpenEXR stands for it: the library turns it into one of its own, with
/// nothing but a text, as if the file was damaged.
inline void throw_if_out_of_memory(const std::exception& problem) {
  if (std::string_view(problem.what()).find("allocate memory") != std::string_view::npos) throw std::bad_alloc();
}

}  // namespace polyrecon
