#include "cli/common/checks.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <set>
#include <utility>

#include "io/files/atomic_file.h"
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

}  // namespace

void require_readable(const std::string& path) {
  std::error_code error;
  if (!fs::exists(path, error)) throw Error(ExitCode::Missing, path + ": no such file");
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

bool names_another_format(const std::string& path) {
  static const std::set<std::string> others{".png", ".jpg", ".jpeg", ".tif", ".tiff",
                                            ".hdr", ".pfm", ".dpx",  ".tga", ".bmp"};
  std::string ending = std::filesystem::path(path).extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return others.count(ending) > 0;
}

void require_exr_name(const NamedPath& output) {
  if (names_another_format(output.path))
    throw Error(ExitCode::Usage,
                fmt::format("{} {}: an EXR file is written; give it the ending .exr (polyrecon preview makes PNG)",
                            output.option, output.path));
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

void require_outputs(const std::vector<std::string>& inputs, const std::vector<NamedPath>& outputs) {
  require_different_files(inputs, outputs);
  std::vector<std::string> paths;
  for (const NamedPath& output : outputs) paths.push_back(output.path);
  require_writable(paths);
}

}  // namespace polyrecon
