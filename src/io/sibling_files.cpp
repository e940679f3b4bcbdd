#include "io/sibling_files.h"

#include <algorithm>
#include <filesystem>
#include <system_error>

#include "io/channel_names.h"
#include "io/renderers/known_names.h"

namespace polyrecon {
namespace {

namespace fs = std::filesystem;

/// Whether the word names a pass that has a role. Words of two letters are too often something else.
bool is_pass(const std::string& word) {
  const auto known = classify_pass(word);
  return word.size() > 2 && known && known->role != Role::Other;
}

/// Whether the word is a pass or a pass with the ending of a companion: "AlbedoVariance", "ColorA".
bool is_pass_or_companion(const std::string& word) {
  static const std::vector<std::string> endings = pass_file_endings();
  return std::any_of(endings.begin(), endings.end(), [&](const std::string& ending) {
    return word.size() > ending.size() && word.compare(word.size() - ending.size(), ending.size(), ending) == 0 &&
           is_pass(word.substr(0, word.size() - ending.size()));
  });
}

}  // namespace

std::string pass_in_file_name(const std::string& path) {
  const std::string stem = fs::path(path).stem().string();
  for (std::size_t begin = 0; begin < stem.size(); ++begin)
    if (is_pass(stem.substr(begin))) return stem.substr(begin);
  return {};
}

std::vector<SiblingFile> find_siblings(const std::string& path) {
  const fs::path self(path);
  const std::string pass = pass_in_file_name(path), stem = self.stem().string();
  if (pass.empty()) return {};
  const std::string shared = stem.substr(0, stem.size() - pass.size());
  std::vector<SiblingFile> siblings;
  std::error_code failure;
  const fs::path folder = self.has_parent_path() ? self.parent_path() : fs::path(".");
  for (fs::directory_iterator entry(folder, failure), end; !failure && entry != end; entry.increment(failure)) {
    const std::string other = entry->path().stem().string();
    if (entry->path().extension() != self.extension() || other == stem || other.compare(0, shared.size(), shared) != 0)
      continue;
    if (const std::string word = other.substr(shared.size()); is_pass_or_companion(word))
      siblings.push_back({entry->path().string(), word});
  }
  std::sort(siblings.begin(), siblings.end(), [](const auto& a, const auto& b) { return a.path < b.path; });
  return siblings;
}

}  // namespace polyrecon
