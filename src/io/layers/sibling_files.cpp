#include "io/layers/sibling_files.h"

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <string_view>
#include <system_error>
#include <utility>

#include "io/layers/channel_names.h"
#include "io/renderers/known_names.h"

namespace polyrecon {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t short_word = 2;  // names of so few letters are too often something else
constexpr std::string_view name_separators = "._- ";

bool is_name_separator(char c) { return name_separators.find(c) != std::string_view::npos; }

/// Whether the word names a pass that has a role. Short ones are features or beauties that stand apart from the rest of
/// the name, in the spelling of a renderer: "shot_N". before: what stands in front of the word.
bool is_pass(const std::string& before, const std::string& word) {
  const auto known = classify_pass(word);
  if (word.empty() || is_name_separator(word.front()) || !known || known->role == Role::Other) return false;
  if (word.size() > short_word) return true;
  const bool apart = before.empty() || is_name_separator(before.back());
  return apart && is_written_so(word) && (info_of(known->role).feature || known->role == Role::Beauty);
}

/// The text without the ending; empty where it does not end so.
std::string without(const std::string& text, const std::string& ending) {
  if (text.size() <= ending.size() || text.compare(text.size() - ending.size(), ending.size(), ending) != 0) return {};
  return text.substr(0, text.size() - ending.size());
}

/// Whether the word is a pass with the ending of a companion, or a beauty with that of a denoiser: "AlbedoVariance",
/// "beauty_denoised".
bool has_known_ending(const std::string& before, const std::string& word) {
  const auto ends_in_one = [&](const std::vector<std::string>& endings) {
    return std::any_of(endings.begin(), endings.end(),
                       [&](const std::string& ending) { return is_pass(before, without(word, ending)); });
  };
  static const std::vector<std::string> companions = companion_endings(), denoised = denoised_endings();
  return ends_in_one(companions) || ends_in_one(denoised);
}

/// The longest known pass at the end of the text.
std::string pass_at_end(const std::string& text) {
  for (std::size_t begin = 0; begin < text.size(); ++begin)
    if (is_pass(text.substr(0, begin), text.substr(begin))) return text.substr(begin);
  return {};
}

/// The parts of a file's name, its extension left out: "shot_" "beauty" ".0001".
struct NameParts {
  std::string before, pass, after;
};

/// The position at which the numbers of frame and version at the end of a name begin; its length if there are none.
/// Each number may have a separator, a v and a minus sign before it, in this order.
std::size_t numbers_at_end(const std::string& name) {
  const auto stands_before = [&](std::size_t at, const char* any_of) {
    return at > 0 && std::strchr(any_of, name[at - 1]) != nullptr;
  };
  std::size_t begin = name.size();
  while (stands_before(begin, "0123456789")) {
    while (stands_before(begin, "0123456789")) --begin;
    for (const char* one_of : {"-", "vV", "._-"}) begin -= stands_before(begin, one_of) ? 1 : 0;
  }
  return begin;
}

/// The word before the first separator if it names a beauty: "beauty_shot.0001".
std::string beauty_at_begin(const std::string& name) {
  const std::string word = name.substr(0, name.find_first_of(name_separators));
  return word.size() < name.size() && is_pass({}, word) && classify_pass(word)->role == Role::Beauty ? word
                                                                                                     : std::string();
}

/// The pass is at the end of the name, or numbers of a frame and a version follow it: ".0001", "_v02.-0005"; a beauty
/// may also stand in front: "beauty_shot.0001". It is empty where no pass is known.
NameParts parts_of(const std::string& path) {
  const std::string stem = fs::path(path).stem().string();
  NameParts parts{stem, pass_at_end(stem), {}};
  if (const std::size_t numbers = numbers_at_end(stem); parts.pass.empty() && numbers < stem.size()) {
    const std::string name = stem.substr(0, numbers);
    parts = {name, pass_at_end(name), stem.substr(numbers)};
  }
  if (parts.pass.empty())
    if (const std::string first = beauty_at_begin(stem); !first.empty()) return {"", first, stem.substr(first.size())};
  parts.before.resize(parts.before.size() - parts.pass.size());
  return parts;
}

/// The text between its two ends; empty if it has no such ends, or nothing between them.
std::string between(const std::string& before, const std::string& text, const std::string& after) {
  const std::size_t ends = before.size() + after.size();
  if (text.size() <= ends || text.compare(0, before.size(), before) != 0 ||
      text.compare(text.size() - after.size(), after.size(), after) != 0)
    return {};
  return text.substr(before.size(), text.size() - ends);
}

/// The feature, or the companion of the beauty, that the word adds to a name: "_albedo", ".Z", "_variance"; else empty.
std::string added_pass(const std::string& word) {
  if (word.empty() || !is_name_separator(word.front())) return {};
  const std::string before = word.substr(0, 1), pass = word.substr(1);
  const bool feature = is_pass(before, pass) && info_of(classify_pass(pass)->role).feature;
  return feature || is_beauty_companion(pass) ? pass : std::string();
}

/// The pass of the file `other` of the render whose files have these parts; empty where it is none of them.
std::string pass_of(const std::string& other, const NameParts& parts) {
  if (!parts.pass.empty()) {
    std::string word = between(parts.before, other, parts.after);
    if (is_pass(parts.before, word) || has_known_ending(parts.before, word) || is_beauty_companion(word) ||
        is_other_pass_file(word))
      return word;
  }
  return added_pass(between(parts.before + parts.pass, other, parts.after));
}

}  // namespace

std::string pass_in_file_name(const std::string& path) { return parts_of(path).pass; }

bool is_denoised_name(const std::string& pass) {
  static const std::vector<std::string> endings = denoised_endings();
  const auto known = classify_pass(pass);
  return (known && known->role == Role::Prior) || std::any_of(endings.begin(), endings.end(), [&](const auto& ending) {
           return !without(pass, ending).empty();
         });
}

std::vector<SiblingFile> find_siblings(const std::string& path) {
  const fs::path self(path);
  const NameParts parts = parts_of(path);
  std::vector<SiblingFile> siblings;
  std::error_code failure;
  const fs::path folder = self.has_parent_path() ? self.parent_path() : fs::path(".");
  for (fs::directory_iterator entry(folder, failure), end; !failure && entry != end; entry.increment(failure)) {
    const std::string other = entry->path().stem().string();
    if (entry->path().extension() != self.extension() || other == self.stem().string()) continue;
    if (std::string pass = pass_of(other, parts); !pass.empty())
      siblings.push_back({entry->path().string(), std::move(pass)});
  }
  std::sort(siblings.begin(), siblings.end(), [](const auto& a, const auto& b) { return a.path < b.path; });
  return siblings;
}

}  // namespace polyrecon
