#include "cli/denoise/job.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <map>
#include <numeric>
#include <set>
#include <system_error>
#include <utility>

#include "cli/common/checks.h"
#include "cli/common/encoding_options.h"
#include "cli/common/frame_names.h"
#include "cli/common/steps_option.h"
#include "pipeline/memory.h"
#include "polyrecon/error.h"
#include "presets/preset.h"

namespace polyrecon {
namespace {

std::optional<FrameLimits> limits_of(const DenoiseOptions& o) {
  const double target = o.outputs.sample_map.empty() ? o.sample_map.params.target : 0;  // else it is the sample map's
  if (o.time_budget <= 0 && target <= 0) return std::nullopt;
  if (o.quality || o.stages || o.order)  // CLI11 excludes them from --time-budget
    throw Error(ExitCode::Usage, "--target chooses the settings itself: remove --quality, --stages and --order");
  return FrameLimits{o.time_budget, target};
}

/// The denoiser that "prior=NAME" names; empty where it is a layer or a file.
std::string denoiser_named(const std::string& role) {
  const RoleMapping mapping = parse_mapping(role);
  return mapping.role == Role::Prior && denoisers().count(mapping.layer) > 0 ? mapping.layer : "";
}

/// The denoiser that makes the prior; empty where none does. Throws Error{Usage} where there is another prior too.
std::string denoiser_named(const DenoiseOptions& o) {
  std::vector<std::string> priors;
  std::string denoiser;
  for (const std::string& role : o.roles)
    if (parse_mapping(role).role == Role::Prior) {
      priors.push_back(role);
      if (denoiser.empty()) denoiser = denoiser_named(role);
    }
  if (!denoiser.empty() && priors.size() > 1)
    throw Error(ExitCode::Usage, fmt::format("--prior {} makes the prior itself: remove the other one", denoiser));
  return denoiser;
}

/// The denoiser that the options request; null where they request none.
MakeDenoiser denoiser_of(const DenoiseOptions& o) {
  const std::string name = denoiser_named(o);
  if (name.empty()) {
    if (o.denoiser.is_default()) return nullptr;
    throw Error(ExitCode::Usage, "--oidn and --oidn-device need --prior oidn");
  }
  return denoisers().at(name);
}

/// Refuses a role that two layers are named for.
void require_one_layer_for_each(const std::vector<RoleMapping>& map, const std::vector<std::string>& words) {
  for (std::size_t j = 0; j < map.size(); ++j)
    for (std::size_t i = 0; i < j; ++i)
      if (map[i].role == map[j].role && map[i].companion == map[j].companion && map[i].layer != map[j].layer)
        throw Error(ExitCode::Usage,
                    fmt::format("--map {} and --map {} name two layers for one role: remove one", words[i], words[j]));
}

ReadOptions read_options_of(const DenoiseOptions& o, const Params& params, bool is_sequence) {
  ReadOptions read = o.read;
  std::vector<std::string> words;
  for (const std::string& role : o.roles)
    if (denoiser_named(role).empty()) {
      read.map.push_back(parse_mapping(role));
      words.push_back(role);
    }
  require_one_layer_for_each(read.map, words);
  read.motion = params.temporal.radius > 0;
  read.accept = [params, is_sequence, denoises = !denoiser_named(o).empty()](const std::string& path,
                                                                             FrameShape shape) {
    if (denoises) add_denoiser(shape);
    if (is_sequence)
      shape.other_channels =
          channels_ahead(shape, params) + neighbours_channels(shape, 2 * params.temporal.radius, params);
    require_memory(path, shape, params);
  };
  return read;
}

/// The parameters of a preset with those that options set, whatever the preset.
Params with_options(Params params, const DenoiseOptions& o, const StepsChoice& steps, int frame_radius) {
  if (o.stages) params.stages = *o.stages;
  if (o.order) params.max_order = *o.order;
  params.max_memory = o.max_memory;
  params.reconstruct_alpha = o.alpha;
  params.temporal.radius = frame_radius;
  return steps.applied_to(std::move(params));
}

Quality quality_of(const DenoiseOptions& o) { return o.quality.value_or(Quality::Standard); }

std::string name_of(Quality quality) {
  return std::find_if(qualities.begin(), qualities.end(), [&](const auto& q) { return q.quality == quality; })->name;
}

std::string settings_of(const OptionSet& set, Quality quality, const Job& job) {
  std::map<std::string, std::string> resolved{{"--frame-radius", std::to_string(job.params.temporal.radius)}};
  if (!job.limits)
    resolved.insert({{"--quality", name_of(quality)},
                     {"--stages", std::to_string(job.params.stages)},
                     {"--order", std::to_string(job.params.max_order)}});
  return set.identity(resolved);
}

/// All of a job that its options decide, without its frames; looks at no file.
Job resolve(const DenoiseOptions& o, int frame_radius, bool is_sequence) {
  Job job;
  job.limits = limits_of(o);
  if (!o.outputs.sample_map.empty()) {
    check_sample_map_options(o.sample_map);
    job.sample_map = o.sample_map;
  }
  const StepsChoice steps = parse_steps(o.steps);
  job.params = with_options(params_for(quality_of(o)), o, steps, frame_radius);
  validate(job.params);
  if (job.limits)
    for (const Preset& preset : presets()) job.presets.push_back(with_options(preset.params, o, steps, frame_radius));
  job.read = read_options_of(o, job.params, is_sequence);
  job.make_denoiser = denoiser_of(o);
  job.denoiser_options = o.denoiser;
  job.contents = parse_contents(o.contents);
  check_encoding(o.encoding);
  job.encoding = o.encoding;
  job.run = o.run;
  job.is_sequence = is_sequence;
  return job;
}

/// More numbers than this between two frames are no gap in a sequence.
constexpr std::int64_t most_gaps = 100'000;

/// The numbers without a frame between the first and the last one. If all are a step apart, so are these.
std::vector<int> gaps_between(const std::vector<FrameFiles>& frames) {
  std::int64_t step = 0;
  for (const FrameFiles& files : frames) step = std::gcd(step, std::int64_t{*files.frame} - *frames.front().frame);
  std::vector<int> gaps;
  for (std::size_t k = 1; k < frames.size(); ++k) {
    const std::int64_t before = *frames[k - 1].frame, after = *frames[k].frame;
    if (after - before > most_gaps * step) continue;
    for (std::int64_t n = before + step; n < after; n += step) gaps.push_back(static_cast<int>(n));
  }
  return gaps;
}

}  // namespace

FrameLimits FrameLimits::after(double spent) const {
  constexpr double least_seconds = 1e-3;
  return {seconds > 0 ? std::max(seconds - spent, least_seconds) : 0, relative_mse};
}

Job make_job(const DenoiseOptions& o, const OptionSet& set) {
  check_options(o);  // before the disk is searched for frames
  FrameList list = list_frames(o);
  Job job = resolve(o, list.radius, list.is_sequence);
  for (const RoleMapping& mapping : job.read.map) job.map_patterns.push_back(FramePattern::parse(mapping.layer));
  if (job.sample_map) job.cost_pattern = FramePattern::parse(job.sample_map->cost);
  job.frames = std::move(list.frames);
  if (o.frames.empty() && !job.frames.empty() && job.frames.front().frame) job.gaps = gaps_between(job.frames);
  job.settings = settings_of(set, quality_of(o), job);
  return job;
}

void check_options(const DenoiseOptions& o) {
  if (!o.frames.empty()) parse_frames(o.frames);
  std::error_code ignored;
  for (const OutputOption& option : output_options())
    if (const std::string& path = o.outputs.*option.path;
        std::filesystem::path(path).has_extension() && !std::filesystem::is_directory(path, ignored))
      require_endings({{option.name, path, file_kind_of(option.kind)}});
  resolve(o, o.frame_radius.value_or(0), false);
}

void check_files(const Job& job) {
  std::vector<std::string> all_outputs;
  for (const FrameFiles& files : job.frames) {
    std::vector<NamedPath> outputs;
    for (const OutputOption& option : output_options()) {
      outputs.push_back({option.name, files.outputs.*option.path, file_kind_of(option.kind)});
      all_outputs.push_back(files.outputs.*option.path);
    }
    require_endings(outputs);
    require_different_files({files.input, job.sample_map ? sample_map_for(job, files).cost : std::string()}, outputs);
  }
  if (job.sample_map && !job.sample_map->cost.empty() && !job.cost_pattern) require_readable(job.sample_map->cost);
  if (!job.is_sequence && job.run.wait <= 0) require_readable(job.frames.front().input);
  if (!job.run.may_replace())
    require_new(all_outputs, job.is_sequence ? ", or --skip-existing to do what is still missing" : "");
  require_writable(all_outputs);
}

Job with_denoiser(Job job) {
  if (job.make_denoiser) job.denoiser = job.make_denoiser(job.denoiser_options);
  return job;
}

ReadOptions read_options_for(const Job& job, std::optional<int> frame) {
  ReadOptions read = job.read;
  for (std::size_t k = 0; k < read.map.size(); ++k)
    if (const auto& pattern = job.map_patterns[k]; pattern && frame) read.map[k].file = pattern->path(*frame);
  return read;
}

SampleMapOptions sample_map_for(const Job& job, const FrameFiles& files) {
  SampleMapOptions options = *job.sample_map;
  if (files.frame) options.frame = *files.frame;
  if (const auto number = files.number_in_names(); job.cost_pattern && number)
    options.cost = job.cost_pattern->path(*number);
  return options;
}

std::vector<std::string> fixed_file_notes(const Job& job, const FrameSource& source) {
  std::set<std::string> fixed;
  for (const RoleMapping& mapping : job.read.map)
    for (const FileInfo& file : source.files)
      if (file.path == mapping.layer && file.path != source.path) fixed.insert(file.path);
  if (job.sample_map && !job.sample_map->cost.empty() && !job.cost_pattern) fixed.insert(job.sample_map->cost);
  std::vector<std::string> notes;
  if (job.is_sequence)
    for (const std::string& path : fixed)
      notes.push_back(
          fmt::format("{} is used for every frame; if each has its own, put #### or %04d into the name", path));
  return notes;
}

std::string settings_of(const Job& job, const FrameFiles& files) {
  // A sample map contains the number of its frame.
  return job.sample_map && files.frame ? fmt::format("{} --frame {}", job.settings, *files.frame) : job.settings;
}

}  // namespace polyrecon
