#include "cli/common/checks.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <utility>

#include "io/files/atomic_file.h"
#include "io/files/missing_file.h"
#include "polyrecon/error.h"

namespace polyrecon {
namespace {

namespace fs = std::filesystem;

/// Whether two paths are the same file, or will be once they are written.
bool same_file(const std::string& a, const std::string& b) {
  std::error_code error;
  if (fs::equivalent(a, b, error) && !error) return true;
  const fs::path first = fs::weakly_canonical(fs::absolute(a, error), error);
  const fs::path second = fs::weakly_canonical(fs::absolute(b, error), error);
  return !error && first == second;
}

/// The endings of a kind of file, in lower case.
struct Endings {
  const char* what;  ///< "an EXR file"
  std::vector<std::string> endings;
};

const Endings& endings_of(FileKind kind) {
  static const std::map<FileKind, Endings> endings{
      {FileKind::Exr, {"an EXR file", {".exr"}}},
      {FileKind::Picture, {"a picture", {".png", ".jpg", ".jpeg", ".tif", ".tiff"}}},
      {FileKind::Page, {"an HTML page", {".html", ".htm"}}},
      {FileKind::Csv, {"a table", {".csv"}}},
      {FileKind::Json, {"JSON", {".json"}}}};
  return endings.at(kind);
}

std::string ending_of(const std::string& path) {
  std::string ending = fs::path(path).extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return ending;
}

}  // namespace

void require_readable(const std::string& path) {
  std::error_code error;
  if (!fs::exists(path, error)) throw missing_file(path);
  if (fs::is_directory(path, error)) throw Error(ExitCode::BadInput, path + ": is a folder; name a file");
  // Opening a pipe waits for its writer, and a device may have no end.
  if (!fs::is_regular_file(path, error)) throw Error(ExitCode::BadInput, path + ": is a pipe or a device; name a file");
  if (!std::ifstream(path)) throw Error(ExitCode::BadInput, path + ": cannot be opened; check its permissions");
}

void require_different_files(const std::vector<std::string>& inputs, const std::vector<NamedPath>& outputs) {
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    const NamedPath& output = outputs[i];
    if (output.path.empty() && output.option == "-o") throw Error(ExitCode::Usage, "-o needs the name of a file");
    if (output.path.empty()) continue;
    for (const std::string& input : inputs)
      if (!input.empty() && same_file(output.path, input))
        throw Error(ExitCode::Usage, output.path + ": is an input; give " + output.option + " another name");
    for (std::size_t j = 0; j < i; ++j)
      if (!outputs[j].path.empty() && same_file(output.path, outputs[j].path))
        throw Error(ExitCode::Usage, output.path + ": is named by both " + outputs[j].option + " and " + output.option);
  }
}

bool has_ending_of(FileKind kind, const std::string& path) {
  const std::vector<std::string>& endings = endings_of(kind).endings;
  return std::find(endings.begin(), endings.end(), ending_of(path)) != endings.end();
}

bool names_another_format(const std::string& path) {
  static const std::set<std::string> others{".hdr", ".pfm", ".dpx", ".tga", ".bmp"};
  return has_ending_of(FileKind::Picture, path) || others.count(ending_of(path)) > 0;
}

void require_endings(const std::vector<NamedPath>& outputs) {
  for (const NamedPath& output : outputs) {
    if (output.path.empty() || has_ending_of(output.kind, output.path)) continue;
    const Endings& endings = endings_of(output.kind);
    const bool is_picture = output.kind == FileKind::Exr && names_another_format(output.path);
    throw Error(ExitCode::Usage, fmt::format("{} {}: {} is written; give it the ending {}{}", output.option,
                                             output.path, endings.what, fmt::join(endings.endings, ", "),
                                             is_picture ? " (polyrecon preview makes pictures to look at)" : ""));
  }
}

void require_new(const std::vector<std::string>& outputs, const std::string& other_way) {
  const std::string* first = nullptr;
  std::size_t others = 0;
  for (const std::string& output : outputs) {
    std::error_code ignored;
    if (output.empty() || !fs::exists(output, ignored) || fs::is_directory(output, ignored)) continue;
    if (first)
      ++others;
    else
      first = &output;
  }
  if (!first) return;
  throw Error(ExitCode::Usage,
              others == 0
                  ? fmt::format("{}: exists already; add --overwrite to replace it{}", *first, other_way)
                  : fmt::format("{}: exists already, and so do {} other outputs; add --overwrite to replace them{}",
                                *first, others, other_way));
}

void require_writable(const std::vector<std::string>& outputs) {
  std::set<std::pair<fs::path, bool>> tried;
  for (const std::string& output : outputs) {
    std::error_code ignored;
    // A folder that takes one file takes all names, except that of a folder in it.
    if (!output.empty() && tried.emplace(fs::path(output).parent_path(), fs::is_directory(output, ignored)).second)
      check_writable(output);
  }
}

void require_outputs(const std::vector<std::string>& inputs, const std::vector<NamedPath>& outputs, bool overwrite) {
  require_different_files(inputs, outputs);
  require_endings(outputs);
  std::vector<std::string> paths;
  for (const NamedPath& output : outputs) paths.push_back(output.path);
  if (!overwrite) require_new(paths);
  require_writable(paths);
}

const char* const overwrite_help = "Replace outputs that exist; default: stop before any work";

void add_overwrite(CLI::App& app, bool& overwrite) { app.add_flag("--overwrite", overwrite, overwrite_help); }

}  // namespace polyrecon
