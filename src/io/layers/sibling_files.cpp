#include "io/layers/sibling_files.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstring>
#include <filesystem>
#include <optional>
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

/// Words in front of a pass in the name of its folder, names of folders with a file for each pass, and words in the
/// names of files with several: "AOV_albedo/", "aovs/", "shot_data".
constexpr std::array<std::string_view, 17> words_for_passes{
    "AOV",   "AOVs",      "pass", "passes",    "elements", "layers",    "multilayer", "data",  "utility",
    "utils", "utilities", "tech", "technical", "features", "denoising", "extra",      "extras"};
constexpr std::size_t least_word_for_passes = 3;  // letters of a word that is not known to mean passes

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
NameParts parts_of(const std::string& stem) {
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

/// Whether the word is a pass, or belongs to one, in a name that begins with `before`.
bool is_pass_or_companion(const std::string& before, const std::string& word) {
  return is_pass(before, word) || has_known_ending(before, word) || is_beauty_companion(word) ||
         is_other_pass_file(word);
}

/// The pass of the file or folder `other` of the render whose files or folders have these parts; empty where it is none
/// of them.
std::string pass_of(const std::string& other, const NameParts& parts) {
  if (!parts.pass.empty())
    if (std::string word = between(parts.before, other, parts.after); is_pass_or_companion(parts.before, word))
      return word;
  return added_pass(between(parts.before + parts.pass, other, parts.after));
}

bool is_word_for_passes(const std::string& word) {
  return std::any_of(words_for_passes.begin(), words_for_passes.end(),
                     [&](std::string_view known) { return same_name(word, known); });
}

/// The pass of a folder that is called "AOV_albedo" next to one whose whole name is its pass; else empty.
std::string pass_behind_word(const std::string& folder, const NameParts& parts) {
  if (parts.pass.empty() || !parts.before.empty()) return {};
  const std::string name = between({}, folder, parts.after);
  const std::size_t end = name.find_first_of(name_separators);
  if (end == std::string::npos || !is_word_for_passes(name.substr(0, end))) return {};
  std::string pass = name.substr(end + 1);
  return is_pass_or_companion({}, pass) ? pass : std::string();
}

template <class Visit>
void visit_folder(const fs::path& folder, const Visit& visit) {
  std::error_code failure;
  for (fs::directory_iterator entry(folder.empty() ? "." : folder, failure), end; !failure && entry != end;
       entry.increment(failure))
    visit(entry->path());
}

bool is_folder(const fs::path& path) {
  std::error_code failure;
  return fs::is_directory(path, failure);
}

/// A folder with files of one pass, or of several where `pass` is empty.
struct PassFolder {
  fs::path path;
  std::string pass;
};

/// Folders that are named after a pass or hold passes, "albedo" and "aovs", in the folder of the file.
std::vector<PassFolder> folders_in(const fs::path& folder) {
  std::vector<PassFolder> folders;
  visit_folder(folder, [&](const fs::path& path) {
    const std::string name = path.filename().string();
    const std::string pass = added_pass("." + name);
    if ((!pass.empty() || is_word_for_passes(name)) && is_folder(path)) folders.push_back({path, pass});
  });
  return folders;
}

/// The folder above a file that is named after a pass.
struct NamedFolder {
  fs::path parent;  ///< The folder that holds it.
  fs::path below;   ///< The folder between it and the file, if there is one: "v01" of "beauty/v01/shot.exr".
  std::string name;
  NameParts parts;
};

/// The nearest of the two folders above the file that is named after a pass.
std::optional<NamedFolder> named_folder(const fs::path& self) {
  std::error_code failure;
  fs::path absolute = fs::absolute(self, failure).lexically_normal().parent_path();
  NamedFolder folder{self.has_parent_path() ? self.parent_path() : ".", {}, {}, {}};
  for (int up = 0; up < 2; ++up) {
    folder.name = absolute.filename().string();
    folder.parts = parts_of(folder.name);
    folder.parent /= "..";
    if (!folder.parts.pass.empty()) return folder;
    folder.below = absolute.filename();
    absolute = absolute.parent_path();
  }
  return std::nullopt;
}

/// The folders of the other passes next to one that is named after a pass: "albedo", "AOV_albedo", "aovs" next to
/// "beauty"; what they have of the same name as the folder below.
std::vector<PassFolder> folders_next_to(const NamedFolder& named) {
  std::vector<PassFolder> folders;
  visit_folder(named.parent, [&](const fs::path& path) {
    const std::string name = path.filename().string();
    if (name == named.name) return;
    std::string pass = pass_of(name, named.parts);
    if (pass.empty()) pass = pass_behind_word(name, named.parts);
    if (pass.empty() && !is_word_for_passes(name)) return;
    if (const fs::path found = (path / named.below).lexically_normal(); is_folder(found))
      folders.push_back({found, pass});
  });
  return folders;
}

/// Whether two words name the same pass, maybe as different renderers do.
bool mean_same_pass(const std::string& a, const std::string& b) {
  const auto known_a = classify_pass(a), known_b = classify_pass(b);
  return same_name(a, b) || (known_a && known_b && known_a->role == known_b->role);
}

bool is_beauty(const std::string& pass) {
  const auto known = classify_pass(pass);
  return known && known->role == Role::Beauty;
}

/// The files of the folder with the pass of its name, or with passes of their own, that belong to a file with this stem
/// and extension.
std::vector<SiblingFile> files_of(const PassFolder& folder, const fs::path& self) {
  const std::string stem = self.stem().string();
  const NameParts parts = parts_of(stem);
  std::vector<SiblingFile> files;
  visit_folder(folder.path, [&](const fs::path& other) {
    if (other.extension() != self.extension()) return;
    const std::string other_stem = other.stem().string();
    const std::string pass = other_stem == stem ? std::string() : pass_of(other_stem, parts);
    if (folder.pass.empty() && !pass.empty()) files.push_back({other.string(), pass});
    if (!folder.pass.empty() && (other_stem == stem || mean_same_pass(pass, folder.pass)))
      files.push_back({other.string(), folder.pass});
  });
  return files;
}

bool is_word(const std::string& text) {
  return text.size() >= least_word_for_passes &&
         std::all_of(text.begin(), text.end(), [](unsigned char c) { return std::isalpha(c) != 0; });
}

/// The word that the name of a file has in place of the pass, or added to the name; empty where it is no word, or names
/// a pass.
std::string word_of(const std::string& other, const NameParts& parts) {
  const std::string in_place = parts.pass.empty() ? std::string() : between(parts.before, other, parts.after);
  const std::string added = between(parts.before + parts.pass, other, parts.after);
  const bool apart = !added.empty() && is_name_separator(added.front());
  for (const std::string& word : {in_place, apart ? added.substr(1) : std::string()})
    if (is_word(word)) return is_pass_or_companion(parts.before, word) ? std::string() : word;
  return {};
}

/// Files in the folder that may hold several passes of a file with this stem and extension. Without a name that the
/// files have in common, only known words count: "beauty.0001" | "aovs.0001".
void add_files_of_several(const PassFolder& folder, bool is_own, const fs::path& self,
                          std::vector<FileOfPasses>& files) {
  if (!folder.pass.empty()) return;
  const std::string stem = self.stem().string();
  const NameParts parts = parts_of(stem);
  const std::size_t before = files.size();
  visit_folder(folder.path, [&](const fs::path& path) {
    if (path.extension() != self.extension()) return;
    const std::string other = path.stem().string(), word = word_of(other, parts);
    const bool named_so = is_word_for_passes(word) || (!is_own && other == stem);
    if (named_so || (is_own && !parts.before.empty() && !word.empty())) files.push_back({path.string(), named_so});
  });
  std::sort(files.begin() + static_cast<std::ptrdiff_t>(before), files.end(),
            [](const auto& a, const auto& b) { return a.path < b.path; });
}

/// Adds the files of the folders with passes that are not there yet. Returns whether it added one.
bool add_files_of(const std::vector<PassFolder>& folders, const fs::path& self, std::vector<SiblingFile>& siblings) {
  std::vector<SiblingFile> files;
  for (const PassFolder& folder : folders)
    for (SiblingFile& file : files_of(folder, self)) files.push_back(std::move(file));
  std::sort(files.begin(), files.end(), [](const auto& a, const auto& b) { return a.path < b.path; });
  const std::size_t before = siblings.size();
  for (SiblingFile& file : files)
    if (std::none_of(siblings.begin(), siblings.end(),
                     [&](const SiblingFile& known) { return same_name(known.pass, file.pass); }))
      siblings.push_back(std::move(file));
  return siblings.size() > before;
}

}  // namespace

std::string pass_in_file_name(const std::string& path) { return parts_of(fs::path(path).stem().string()).pass; }

bool is_denoised_name(const std::string& pass) {
  static const std::vector<std::string> endings = denoised_endings();
  const auto known = classify_pass(pass);
  return (known && known->role == Role::Prior) || std::any_of(endings.begin(), endings.end(), [&](const auto& ending) {
           return !without(pass, ending).empty();
         });
}

FilesOfRender find_siblings(const std::string& path) {
  const fs::path self(path);
  FilesOfRender render{pass_in_file_name(path), {}, {}};
  const std::vector<PassFolder> below = folders_in(self.parent_path());
  add_files_of({{self.parent_path(), {}}}, self, render.others);
  add_files_of(below, self, render.others);
  add_files_of_several({self.parent_path(), {}}, true, self, render.of_several);
  for (const PassFolder& folder : below) add_files_of_several(folder, false, self, render.of_several);
  const auto named = named_folder(self);
  if (!named) return render;
  const std::vector<PassFolder> folders = folders_next_to(*named);
  // A folder that is named after a feature holds one if there is a beauty: "shadow" may be the name of a shot, too.
  const bool has_beauty = is_beauty(named->parts.pass) ||
                          std::any_of(folders.begin(), folders.end(), [](const auto& f) { return is_beauty(f.pass); });
  if (!has_beauty) return render;
  if (add_files_of(folders, self, render.others) && render.pass.empty()) render.pass = named->parts.pass;
  for (const PassFolder& folder : folders) add_files_of_several(folder, false, self, render.of_several);
  return render;
}

}  // namespace polyrecon
