#include "io/sibling_files.h"

#include <algorithm>
#include <filesystem>
#include <regex>
#include <system_error>
#include <utility>

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

/// The longest known pass at the end of the text.
std::string pass_at_end(const std::string& text) {
  for (std::size_t begin = 0; begin < text.size(); ++begin)
    if (is_pass(text.substr(begin))) return text.substr(begin);
  return {};
}

/// The parts of a file's name, its extension left out: "shot_" "beauty" ".0001".
struct NameParts {
  std::string before, pass, after;
};

/// The pass is at the end of the name, or numbers of a frame and a version follow it: ".0001", "_v02.-0005". It is
/// empty where no pass is known.
NameParts parts_of(const std::string& path) {
  static const std::regex numbers(R"((.*?)((?:[._-]?[vV]?-?\d+)+))");
  const std::string stem = fs::path(path).stem().string();
  NameParts parts{stem, pass_at_end(stem), {}};
  std::smatch match;
  if (parts.pass.empty() && std::regex_match(stem, match, numbers)) parts = {match[1], pass_at_end(match[1]), match[2]};
  parts.before.resize(parts.before.size() - parts.pass.size());
  return parts;
}

/// What stands between the two ends of the text; empty where it has no such ends, or nothing between them.
std::string between(const std::string& before, const std::string& text, const std::string& after) {
  const std::size_t ends = before.size() + after.size();
  if (text.size() <= ends || text.compare(0, before.size(), before) != 0 ||
      text.compare(text.size() - after.size(), after.size(), after) != 0)
    return {};
  return text.substr(before.size(), text.size() - ends);
}

/// The feature that the word adds to the name of a beauty without a pass, "_albedo" or ".Normal"; else empty.
std::string added_feature(const std::string& word) {
  if (word.find_first_of("._-") != 0) return {};
  const std::string pass = word.substr(1);
  return is_pass(pass) && info_of(classify_pass(pass)->role).feature ? pass : std::string();
}

}  // namespace

std::string pass_in_file_name(const std::string& path) { return parts_of(path).pass; }

std::vector<SiblingFile> find_siblings(const std::string& path) {
  const fs::path self(path);
  const NameParts parts = parts_of(path);
  std::vector<SiblingFile> siblings;
  std::error_code failure;
  const fs::path folder = self.has_parent_path() ? self.parent_path() : fs::path(".");
  for (fs::directory_iterator entry(folder, failure), end; !failure && entry != end; entry.increment(failure)) {
    const std::string other = entry->path().stem().string();
    if (entry->path().extension() != self.extension() || other == self.stem().string()) continue;
    const std::string word = between(parts.before, other, parts.after);
    if (parts.pass.empty()) {
      if (std::string feature = added_feature(word); !feature.empty())
        siblings.push_back({entry->path().string(), std::move(feature)});
    } else if (is_pass_or_companion(word)) {
      siblings.push_back({entry->path().string(), word});
    }
  }
  std::sort(siblings.begin(), siblings.end(), [](const auto& a, const auto& b) { return a.path < b.path; });
  return siblings;
}

}  // namespace polyrecon
