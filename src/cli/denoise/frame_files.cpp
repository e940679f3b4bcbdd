#include "cli/denoise/frame_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <set>
#include <system_error>

#include "cli/common/frame_names.h"
#include "cli/denoise/denoise_options.h"
#include "polyrecon/error.h"

namespace polyrecon {
namespace {

namespace fs = std::filesystem;

/// An output option and the place of its path in FrameFiles.
struct OutputName {
  const char* option;
  const std::string* given;
  std::string FrameFiles::*path;
};

std::vector<OutputName> output_names(const DenoiseOptions& o) {
  return {{"-o", &o.output, &FrameFiles::output},
          {"--error-map", &o.error_map, &FrameFiles::error_map},
          {"--order-map", &o.order_map, &FrameFiles::order_map},
          {"--sample-map", &o.sample_map, &FrameFiles::sample_map},
          {"--report", &o.report, &FrameFiles::report}};
}

/// Where the outputs of a list go without a pattern: the input's name in a folder.
std::string in_folder(const OutputName& name, const std::string& input) {
  std::error_code ignored;
  if (!fs::is_directory(*name.given, ignored))
    throw Error(ExitCode::Usage, fmt::format("{} {}: several inputs need a folder that exists, or #### in the name",
                                             name.option, *name.given));
  fs::path file = fs::path(input).filename();
  if (name.path == &FrameFiles::report) file.replace_extension(".json");
  return (fs::path(*name.given) / file).string();
}

/// Neighbours by number, whether they are asked for or not.
void add_neighbours(const FramePattern& inputs, int radius, std::vector<FrameFiles>& frames) {
  std::set<int> asked;
  for (const FrameFiles& files : frames) asked.insert(*files.frame);
  for (FrameFiles& files : frames)
    for (int k = -radius; k <= radius; ++k)
      if (k != 0)
        files.neighbours.push_back(
            {k, *files.frame + k, inputs.path(*files.frame + k), asked.count(*files.frame + k) > 0});
}

/// Neighbours by their place in the list.
void add_neighbours(int radius, std::vector<FrameFiles>& frames) {
  const int count = static_cast<int>(frames.size());
  for (int n = 0; n < count; ++n)
    for (int k = std::max(-radius, -n); k <= std::min(radius, count - 1 - n); ++k)
      if (k != 0)
        frames[static_cast<std::size_t>(n)].neighbours.push_back(
            {k, n + k, frames[static_cast<std::size_t>(n + k)].input, true});
}

std::vector<FrameFiles> frames_of_pattern(const DenoiseOptions& o, const FramePattern& inputs) {
  std::vector<FrameFiles> frames;
  for (const int n : o.frames.empty() ? inputs.existing_frames() : parse_frames(o.frames)) {
    frames.emplace_back();
    frames.back().frame = frames.back().place = n;
    frames.back().input = inputs.path(n);
  }
  for (const OutputName& name : output_names(o)) {
    if (name.given->empty()) continue;
    const auto pattern = FramePattern::parse(*name.given);
    if (!pattern)
      throw Error(ExitCode::Usage,
                  fmt::format("{} {}: a sequence needs #### or %04d in the name", name.option, *name.given));
    for (FrameFiles& files : frames) files.*name.path = pattern->path(*files.frame);
  }
  add_neighbours(inputs, frame_radius_of(o), frames);
  return frames;
}

std::vector<FrameFiles> frames_of_list(const DenoiseOptions& o) {
  std::vector<FrameFiles> frames;
  for (const std::string& input : o.inputs) {
    frames.emplace_back();
    frames.back().input = input;
    frames.back().frame = frame_in_name(input);
    frames.back().place = static_cast<int>(frames.size()) - 1;
  }
  for (const OutputName& name : output_names(o)) {
    if (name.given->empty()) continue;
    const auto pattern = FramePattern::parse(*name.given);
    for (FrameFiles& files : frames) {
      if (pattern && !files.frame)
        throw Error(ExitCode::Usage,
                    fmt::format("{}: no frame number in the name for {} {}", files.input, name.option, *name.given));
      files.*name.path = pattern ? pattern->path(*files.frame) : in_folder(name, files.input);
    }
  }
  add_neighbours(frame_radius_of(o), frames);
  return frames;
}

void require_different_outputs(const std::vector<FrameFiles>& frames, const DenoiseOptions& o) {
  std::set<std::string> taken;
  for (const FrameFiles& files : frames)
    for (const OutputName& name : output_names(o)) {
      const std::string& path = files.*name.path;
      if (!path.empty() && !taken.insert(path).second)
        throw Error(ExitCode::Usage, fmt::format("{}: would be written twice, by {}", path, name.option));
    }
}

}  // namespace

std::string FrameFiles::label() const { return frame ? fmt::format("frame {}", *frame) : input; }

bool is_sequence(const DenoiseOptions& o) {
  return o.inputs.size() != 1 || FramePattern::parse(o.inputs.front()).has_value();
}

std::vector<FrameFiles> list_frames(const DenoiseOptions& o) {
  std::vector<FrameFiles> frames;
  if (o.inputs.size() == 1) {
    if (const auto pattern = FramePattern::parse(o.inputs.front()))
      frames = frames_of_pattern(o, *pattern);
    else if (!o.frames.empty())
      throw Error(ExitCode::Usage,
                  fmt::format("--frames {}: -i {} has no #### or %04d in its name", o.frames, o.inputs.front()));
    else
      frames = {{o.inputs.front(), o.output, o.error_map, o.order_map, o.sample_map, o.report, std::nullopt, 0, {}}};
  } else {
    if (!o.frames.empty()) throw Error(ExitCode::Usage, "--frames goes with one -i that has #### in its name");
    frames = frames_of_list(o);
  }
  require_different_outputs(frames, o);
  return frames;
}

}  // namespace polyrecon
