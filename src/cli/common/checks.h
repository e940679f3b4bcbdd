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

/// Throws Error{Usage} where two outputs, or an output and an input, are one file (by links too).
void require_different_files(const std::vector<std::string>& inputs, const std::vector<NamedPath>& outputs);

/// Throws Error{CannotWrite} where an output's folder cannot be written to; each folder is tried once.
void require_writable(const std::vector<std::string>& outputs);

/// Both, for commands that write a few files once.
void require_outputs(const std::vector<std::string>& inputs, const std::vector<NamedPath>& outputs);

}  // namespace polyrecon
