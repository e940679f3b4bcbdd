#include "cli/denoise/folder.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <system_error>

#include "cli/common/checks.h"
#include "cli/common/frame_names.h"
#include "io/files/file.h"
#include "io/layers/sibling_files.h"
#include "io/renderers/known_names.h"
#include "io/renderers/polyrecon.h"
#include "polyrecon/error.h"

namespace polyrecon {
namespace {

namespace fs = std::filesystem;

/// A file, or files whose names differ only in the number at the end.
struct Group {
  FoundRender render;
  std::string first;  ///< Path of the first file.
};

constexpr const char* digits = "0123456789";

/// The stem without the number at its end.
std::string before_number(const std::string& stem) {
  const std::size_t last = stem.find_last_not_of(digits);
  return stem.substr(0, last == std::string::npos ? 0 : last + 1);
}

/// The pattern that all these files of one folder have; nothing where one is not named by it.
std::optional<FoundRender> sequence_of(const std::vector<fs::path>& files) {
  const std::string before = before_number(files.front().stem().string());
  std::size_t width = std::string::npos;
  for (const fs::path& file : files) width = std::min(width, file.stem().string().size() - before.size());
  const std::string name = before + std::string(width, '#') + files.front().extension().string();
  FoundRender render{(files.front().parent_path() / name).string(), {}};
  const auto pattern = FramePattern::parse(render.input);
  if (!pattern) return std::nullopt;
  for (const fs::path& file : files) {
    const auto frame = pattern->frame_of(file.string());
    if (!frame) return std::nullopt;
    render.frames.push_back(*frame);
  }
  std::sort(render.frames.begin(), render.frames.end());
  return render;
}

std::vector<Group> groups_in(const std::string& folder) {
  std::map<std::pair<std::string, std::string>, std::vector<fs::path>> by_name;
  std::vector<Group> groups;
  std::error_code failure;
  for (fs::directory_iterator entry(folder, failure), end; !failure && entry != end; entry.increment(failure)) {
    const fs::path path = entry->path();
    if (!has_ending_of(FileKind::Exr, path.string()) || path.filename().string().front() == '.') continue;
    if (std::error_code ignored; !fs::is_regular_file(path, ignored)) continue;
    const std::string stem = path.stem().string(), before = before_number(stem);
    if (before.size() == stem.size())
      groups.push_back({{path.string(), {}}, path.string()});
    else
      by_name[{before, path.extension().string()}].push_back(path);
  }
  for (auto& [name, files] : by_name) {
    std::sort(files.begin(), files.end());
    const auto sequence = files.size() > 1 ? sequence_of(files) : std::nullopt;
    if (sequence)
      groups.push_back({*sequence, FramePattern::parse(sequence->input)->path(sequence->frames.front())});
    else
      for (const fs::path& file : files) groups.push_back({{file.string(), {}}, file.string()});
  }
  std::sort(groups.begin(), groups.end(), [](const Group& a, const Group& b) { return a.first < b.first; });
  return groups;
}

bool is_beauty_by_name(const std::string& path) {
  const auto pass = classify_pass(pass_in_file_name(path));
  return pass && pass->role == Role::Beauty;
}

/// The files that hold a pass of another one, by the render that they belong to.
std::map<std::string, std::string> passes_of_others(const std::vector<Group>& groups) {
  std::map<std::string, std::string> passes;
  for (const Group& group : groups)
    for (const SiblingFile& sibling : find_siblings(group.first).others)
      if (!is_beauty_by_name(sibling.path)) passes.emplace(sibling.path, group.first);
  return passes;
}

/// Why the file is no render to denoise; empty where it is one.
std::string why_left_out(const std::string& path, const ReadOptions& options) {
  try {
    const FileInfo file = describe_file(path, options.limits);
    if (find_attribute(file.parts.front(), settings_attribute)) return "a result of denoise";
    for (const ChannelInfo& channel : file.parts.front().channels)
      if (channel.name == "relmse.Y") return "an error map";
    read_frame_header(path, options);
  } catch (const Error& error) {
    if (error.code() == ExitCode::Missing) return "no beauty";
  }
  return {};  // a damaged file fails when it is its turn
}

}  // namespace

FolderContents find_renders(const std::string& folder, const ReadOptions& options) {
  FolderContents contents;
  const std::vector<Group> groups = groups_in(folder);
  const auto passes = passes_of_others(groups);
  for (const Group& group : groups) {
    const auto pass = passes.find(group.first);
    const std::string why = pass != passes.end() && !is_beauty_by_name(group.first)
                                ? "a pass of " + fs::path(pass->second).filename().string()
                                : why_left_out(group.first, options);
    if (why.empty())
      contents.renders.push_back(group.render);
    else
      contents.left_out.push_back({group.render.input, why});
  }
  if (contents.renders.empty())
    throw Error(
        ExitCode::Missing,
        fmt::format("{}: no EXR file with a beauty in this folder (polyrecon inspect FILE lists the layers)", folder));
  return contents;
}

}  // namespace polyrecon
