#include "cli/common/sample_map_options.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>

#include "cli/common/checks.h"
#include "cli/common/choice.h"
#include "cli/common/layers.h"
#include "polyrecon/error.h"

namespace polyrecon {
namespace {

const std::map<std::string, SampleMapFormat> formats{
    {"appleseed", SampleMapFormat::Appleseed}, {"luxcore", SampleMapFormat::Luxcore}, {"vray", SampleMapFormat::Vray}};

/// What the renderer has to be told along with the file.
std::string usage_of(const SampleMap& map, SampleMapFormat format) {
  switch (format) {
    case SampleMapFormat::Appleseed:
      return fmt::format("; for appleseed's texture_controlled_pixel_renderer set min_samples 0, max_samples {:.0f}",
                         map.max);
    case SampleMapFormat::Luxcore:
      return "; load it into LuxCore's USER_IMPORTANCE channel, with sampler.sobol.adaptive.userimportanceweight 1";
    case SampleMapFormat::Vray:
      return "; use it as V-Ray's render mask texture: V-Ray has no map of counts";
    case SampleMapFormat::Polyrecon:
      break;
  }
  return {};
}

std::string summary(const SampleMap& map, const SampleMapOptions& options) {
  std::string text = fmt::format(
      "{:.4g} extra samples per pixel (min {:.4g}, max {:.4g}, total {:.6g}), relMSE {:.3g} -> {:.3g} predicted",
      map.total / static_cast<double>(map.samples.pixels()), map.min, map.max, map.total, map.error_before,
      map.error_after);
  if (map.unknown_pixels)
    text += fmt::format("; {} pixels without a finite error count as average", map.unknown_pixels);
  if (map.total <= 0)
    text += options.params.target > 0 && map.limit_met ? "; the target is reached already"
                                                       : "; no error is left that more samples could lower";
  else if (!map.limit_met)
    text += fmt::format("; {} not met: no pixel takes more than {:.6g} samples (--max-samples)",
                        options.params.target > 0 ? "the target is" : "the budget is", options.params.max_samples);
  return text;
}

}  // namespace

void add_sample_map_options(CLI::App& app, SampleMapOptions& o) {
  const std::string group = "Sample map";
  CLI::Option* budget =
      app.add_option("--budget", o.params.budget, "Extra samples per pixel on average")->check(CLI::PositiveNumber);
  CLI::Option* target = app.add_option("--target", o.params.target,
                                       "Mean relative MSE to reach instead of a budget; in denoise without a sample "
                                       "map: by the cheapest settings")
                            ->check(CLI::PositiveNumber);
  target->excludes(budget)->group(group);
  budget->group(group);
  app.add_option("--max-samples", o.params.max_samples, "Most extra samples of one pixel")
      ->check(CLI::PositiveNumber)
      ->capture_default_str()
      ->group(group);
  app.add_option(
         "--cost", o.cost,
         "Image of the seconds a sample takes in each pixel (a render time pass): the budget then counts seconds, "
         "in samples of average cost")
      ->type_name("FILE")
      ->group(group);
  app.add_option("--frame", o.frame, "Frame number to write into the map")->capture_default_str()->group(group);
  app.add_option("--seed", o.seed, "Seed of the next pass to write into the map")->capture_default_str()->group(group);
  add_choice(app, "--export", o.format, formats, "Write the map for a renderer: appleseed, luxcore or vray")
      ->group(group);
}

bool any_sample_map_option(const CLI::App& app) {
  constexpr std::array<const char*, 6> names{"--budget", "--max-samples", "--cost", "--frame", "--seed", "--export"};
  return std::any_of(names.begin(), names.end(), [&](const char* name) { return app.count(name) > 0; });
}

std::string sample_map_settings(const SampleMapOptions& o) {
  std::string text = o.params.target > 0 ? fmt::format(" --target {:g}", o.params.target)
                                         : fmt::format(" --budget {:g}", o.params.budget);
  text += fmt::format(" --max-samples {:g} --frame {} --seed {}", o.params.max_samples, o.frame, o.seed);
  if (!o.cost.empty()) text += " --cost '" + o.cost + "'";
  for (const auto& [name, format] : formats)
    if (format == o.format) text += " --export " + name;
  return text;
}

void check_sample_map_options(const SampleMapOptions& options) {
  if (options.params.budget <= 0 && options.params.target <= 0)
    throw Error(ExitCode::Usage, "a sample map needs --budget or --target");
  if (options.params.budget > options.params.max_samples)
    throw Error(ExitCode::Usage, fmt::format("--budget {:g} is above --max-samples {:g}", options.params.budget,
                                             options.params.max_samples));
  validate(options.params);
  if (!options.cost.empty()) require_readable(options.cost);
}

std::string make_and_write_sample_map(const std::string& target, const ErrorMap& error, const Image& sample_count,
                                      const MapWindows& windows, const SampleMapOptions& options, Progress& progress) {
  Image cost;
  if (!options.cost.empty()) {
    cost = read_cost(options.cost);
    if (!cost.same_shape(error.relative_mse))
      throw Error(ExitCode::BadInput,
                  fmt::format("{}: is {} x {} pixels, the frame has {} x {}", options.cost, cost.width(), cost.height(),
                              error.relative_mse.width(), error.relative_mse.height()));
  }
  const SampleMap map = make_sample_map(error, sample_count, cost, options.params, progress);
  write_sample_map(target, map, windows, {options.params.budget, options.params.target, options.frame, options.seed},
                   options.format);
  std::string text = summary(map, options) + usage_of(map, options.format);
  if (sample_count.empty())
    text += fmt::format("; the file does not tell its samples per pixel, {:g} are assumed (--samples)",
                        options.params.assumed_samples);
  return text;
}

}  // namespace polyrecon
