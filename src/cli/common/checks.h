#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace polyrecon {

/// The kind of a file that a command writes; the ending of its name has to fit.
enum class FileKind {
  Exr,      ///< Pictures, maps and merges.
  Picture,  ///< To look at: PNG, JPEG or TIFF.
  Page,     ///< HTML.
  Csv,
  Json
};

/// A path and the option that named it; empty where the option was not given.
struct NamedPath {
  std::string option;  ///< "--error-map"
  std::string path;
  FileKind kind = FileKind::Exr;
};

/// Throws Error{Missing} where the file does not exist, Error{BadInput} where it is a folder or cannot be opened.
void require_readable(const std::string& path);

/// Throws Error{Usage} where two outputs, or an output and an input, are the same file, also through links.
void require_different_files(const std::vector<std::string>& inputs, const std::vector<NamedPath>& outputs);

/// Whether the ending of the path, whatever its case, is one of the kind.
bool has_ending_of(FileKind kind, const std::string& path);

/// Whether the path has the ending of a picture in another format than EXR.
bool names_another_format(const std::string& path);

/// Throws Error{Usage} where the ending of a path is not one of its kind: "clean.png" would be an EXR file.
void require_endings(const std::vector<NamedPath>& outputs);

/// Throws Error{Usage} where one of the files exists. The message names the first one and the number of the others.
/// other_way: what can be done instead of overwriting them, to be added to it.
void require_new(const std::vector<std::string>& outputs, const std::string& other_way = {});

/// Throws Error{CannotWrite} where an output cannot be written into its folder, or where the folder cannot be made.
/// Each folder is tried once.
void require_writable(const std::vector<std::string>& outputs);

/// All checks, for commands that write a few files.
void require_outputs(const std::vector<std::string>& inputs, const std::vector<NamedPath>& outputs, bool overwrite);

/// The help of --overwrite, which every command that writes files has.
extern const char* const overwrite_help;

/// Adds --overwrite.
void add_overwrite(CLI::App& app, bool& overwrite);

}  // namespace polyrecon
