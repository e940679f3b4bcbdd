#include "cli/denoise/frame_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <set>
#include <system_error>

#include "cli/common/checks.h"
#include "cli/common/frame_names.h"
#include "cli/denoise/options.h"
#include "polyrecon/error.h"

namespace polyrecon {
namespace {

namespace fs = std::filesystem;

/// Whether an output is a folder: one that exists, or a name that ends in '/'.
bool is_folder(const std::string& path) {
  std::error_code ignored;
  return !path.empty() && (path.back() == '/' || fs::is_directory(path, ignored));
}

/// Adds the frames with the nearest numbers, whether the run denoises them or not.
void add_neighbours(const FramePattern& inputs, int radius, std::vector<FrameFiles>& frames) {
  std::set<int> worked;
  for (const FrameFiles& files : frames) worked.insert(*files.frame);
  for (FrameFiles& files : frames)
    for (int k = -radius; k <= radius; ++k)
      if (k != 0)
        files.neighbours.push_back(
            {k, *files.frame + k, *files.frame + k, inputs.path(*files.frame + k), worked.count(*files.frame + k) > 0});
}

/// Adds the files before and after in the list.
void add_neighbours(int radius, std::vector<FrameFiles>& frames) {
  const int count = static_cast<int>(frames.size());
  for (int n = 0; n < count; ++n)
    for (int k = std::max(-radius, -n); k <= std::min(radius, count - 1 - n); ++k)
      if (k != 0) {
        const FrameFiles& other = frames[static_cast<std::size_t>(n + k)];
        frames[static_cast<std::size_t>(n)].neighbours.push_back({k, n + k, other.frame, other.input, true});
      }
}

std::vector<FrameFiles> frames_of_pattern(const DenoiseOptions& o, const FramePattern& inputs, int radius) {
  std::vector<FrameFiles> frames;
  for (const int n : o.frames.empty() ? inputs.existing_frames() : parse_frames(o.frames)) {
    frames.emplace_back();
    frames.back().frame = frames.back().place = n;
    frames.back().input = inputs.path(n);
  }
  for (const OutputOption& option : output_options()) {
    std::string given = o.outputs.*option.path;
    if (given.empty() && option.kind == OutputKind::Picture) given = default_output(o.inputs.front());
    if (given.empty()) continue;
    const std::string named = is_folder(given) ? path_in_folder(option, given, o.inputs.front()) : given;
    const auto pattern = FramePattern::parse(named);
    if (!pattern)
      throw Error(ExitCode::Usage,
                  fmt::format("{} {}: for a sequence, put #### or %04d into the file's name, or name a folder: {}/",
                              option.name, given, std::filesystem::path(given).replace_extension().string()));
    for (FrameFiles& files : frames) files.outputs.*option.path = pattern->path(*files.frame);
  }
  add_neighbours(inputs, radius, frames);
  return frames;
}

std::vector<FrameFiles> frames_of_list(const DenoiseOptions& o, int radius) {
  if (!o.frames.empty())
    throw Error(ExitCode::Usage, "--frames needs a single -i with #### or %04d in its name, not a list of files");
  std::vector<FrameFiles> frames;
  for (const std::string& input : o.inputs) {
    frames.emplace_back();
    frames.back().input = input;
    frames.back().frame = frame_in_name(input);
    frames.back().place = static_cast<int>(frames.size()) - 1;
  }
  for (const OutputOption& option : output_options()) {
    const std::string& given = o.outputs.*option.path;
    if (given.empty() && option.kind != OutputKind::Picture) continue;
    if (given.empty()) {
      for (FrameFiles& files : frames) files.outputs.*option.path = default_output(files.input);
      continue;
    }
    const auto pattern = FramePattern::parse(given);
    if (!pattern && has_ending_of(file_kind_of(option.kind), given) && !is_folder(given))
      throw Error(ExitCode::Usage,
                  fmt::format("{} {}: with several inputs, name a folder, or put #### into the file's name",
                              option.name, given));
    for (FrameFiles& files : frames) {
      if (pattern && !files.frame)
        throw Error(ExitCode::Usage,
                    fmt::format("{}: the name has no frame number to put into {} {}", files.input, option.name, given));
      files.outputs.*option.path = pattern ? pattern->path(*files.frame) : path_in_folder(option, given, files.input);
    }
  }
  add_neighbours(radius, frames);
  return frames;
}

FrameFiles single_file(const DenoiseOptions& o) {
  if (!o.frames.empty())
    throw Error(ExitCode::Usage,
                fmt::format("--frames {}: -i {} has no #### or %04d in its name", o.frames, o.inputs.front()));
  if (o.frame_radius.value_or(0) > 0)
    throw Error(ExitCode::Usage, "--frame-radius needs a sequence: -i with #### or %04d in its name, or several files");
  FrameFiles files;
  files.input = o.inputs.front();
  files.outputs = o.outputs;
  for (const OutputOption& option : output_options())
    if (std::string& path = files.outputs.*option.path; is_folder(path))
      path = path_in_folder(option, path, files.input);
  if (files.outputs.picture.empty()) files.outputs.picture = default_output(files.input);
  return files;
}

void require_different_outputs(const std::vector<FrameFiles>& frames) {
  std::set<std::string> taken;
  for (const FrameFiles& files : frames)
    for (const OutputOption& option : output_options()) {
      const std::string& path = files.outputs.*option.path;
      if (!path.empty() && !taken.insert(path).second)
        throw Error(ExitCode::Usage,
                    fmt::format("{}: two outputs have this name, one of them by {}", path, option.name));
    }
}

}  // namespace

const std::array<OutputOption, 5>& output_options() {
  static const std::array<OutputOption, 5> options{{{"-o", &OutputPaths::picture, OutputKind::Picture},
                                                    {"--error-map", &OutputPaths::error_map, OutputKind::Map},
                                                    {"--order-map", &OutputPaths::order_map, OutputKind::Map},
                                                    {"--sample-map", &OutputPaths::sample_map, OutputKind::Map},
                                                    {"--report", &OutputPaths::report, OutputKind::Report}}};
  return options;
}

FileKind file_kind_of(OutputKind kind) { return kind == OutputKind::Report ? FileKind::Json : FileKind::Exr; }

std::string default_output(const std::string& input) {
  const fs::path path(input);
  const std::string stem = path.stem().string();
  std::size_t place = number_begin(stem).value_or(std::string::npos);
  while (place != std::string::npos && place > 0 && std::string("._-").find(stem[place - 1]) != std::string::npos)
    --place;
  const std::string before = stem.substr(0, place);
  const std::string after = place == std::string::npos ? std::string() : stem.substr(place);
  const std::string name = before.empty() ? "denoised." + after : before + "_denoised" + after;
  return (path.parent_path() / (name + ".exr")).string();
}

std::string path_in_folder(const OutputOption& option, const std::string& folder, const std::string& input) {
  const FileKind kind = file_kind_of(option.kind);
  fs::path file = fs::path(input).filename();
  if (kind == FileKind::Json)
    file.replace_extension(".json");
  else if (names_another_format(input))
    file.replace_extension(".exr");
  else if (!has_ending_of(kind, input))
    file += ".exr";
  return (fs::path(folder) / file).string();
}

std::string FrameFiles::label() const { return frame ? fmt::format("frame {}", *frame) : input; }

std::optional<int> FrameFiles::number_in_names() const { return frame ? frame : frame_in_name(input); }

FrameList list_frames(const DenoiseOptions& o) {
  const auto pattern = o.inputs.size() == 1 ? FramePattern::parse(o.inputs.front()) : std::nullopt;
  FrameList list;
  list.is_sequence = pattern || o.inputs.size() > 1;
  list.radius = o.frame_radius.value_or(list.is_sequence ? default_frame_radius : 0);
  if (pattern)
    list.frames = frames_of_pattern(o, *pattern, list.radius);
  else if (list.is_sequence)
    list.frames = frames_of_list(o, list.radius);
  else
    list.frames = {single_file(o)};
  require_different_outputs(list.frames);
  return list;
}

}  // namespace polyrecon
