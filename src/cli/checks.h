#pragma once

#include <string>
#include <vector>

namespace polyrecon {

/// Checks that come before any work. A path of an option is empty where the option was not given.
struct NamedPath {
  std::string option;  ///< "--error-map"
  std::string path;
};

/// Throws Error{Missing} unless path is a file that can be opened.
void require_readable(const std::string& path);

/// Throws Error{Usage} where two outputs, or an output and an input, are one file (by links too), then
/// Error{CannotWrite} where an output's folder cannot be written to.
void require_outputs(const std::vector<std::string>& inputs, const std::vector<NamedPath>& outputs);

}  // namespace polyrecon
