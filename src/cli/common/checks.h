#pragma once

#include <string>
#include <vector>

namespace polyrecon {

/// A path and the option that named it; empty where the option was not given.
struct NamedPath {
  std::string option;  ///< "--error-map"
  std::string path;
};

/// Throws Error{Missing} where the file does not exist, Error{BadInput} where it is a folder or cannot be opened.
void require_readable(const std::string& path);

/// Throws Error{Usage} where two outputs, or an output and an input, are the same file, also through links.
void require_different_files(const std::vector<std::string>& inputs, const std::vector<NamedPath>& outputs);

/// Whether the path has the ending of a picture in another format than EXR.
bool names_another_format(const std::string& path);

/// Throws Error{Usage} where the path has the ending of another picture format: "clean.png" would be an EXR file.
void require_exr_name(const NamedPath& output);

/// Throws Error{CannotWrite} where the folder of an output cannot be written to. Each folder is tried once.
void require_writable(const std::vector<std::string>& outputs);

/// Both checks, for commands that write a few files.
void require_outputs(const std::vector<std::string>& inputs, const std::vector<NamedPath>& outputs);

}  // namespace polyrecon
