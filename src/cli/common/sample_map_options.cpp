#include "cli/common/sample_map_options.h"

#include <fmt/format.h>

#include <string_view>

#include "cli/common/layers.h"
#include "cli/common/numbers.h"
#include "polyrecon/error.h"

namespace polyrecon {
namespace {

/// The renderers' formats by what is typed after --export.
Choices<const SampleMapFormat*> formats() {
  Choices<const SampleMapFormat*> by_option;
  for (const Renderer& renderer : renderers())
    if (!renderer.sample_map.option.empty()) by_option.emplace_back(renderer.sample_map.option, &renderer.sample_map);
  return by_option;
}

/// How to use the file in the renderer.
std::string usage_of(const SampleMap& map, const SampleMapFormat* format) {
  if (!format) return {};
  std::string usage = "; " + format->usage;
  const std::string_view place = "{max}";
  if (const std::size_t at = usage.find(place); at != std::string::npos)
    usage.replace(at, place.size(), fmt::format("{:.0f}", map.max));
  return usage;
}

std::string summary(const SampleMap& map, const SampleMapOptions& options) {
  std::string text = fmt::format(
      "{:.4g} extra samples per pixel (min {:.4g}, max {:.4g}, total {:.6g}), predicted relMSE {:.3g} -> {:.3g}",
      map.total / static_cast<double>(map.samples.pixels()), map.min, map.max, map.total, map.error_before,
      map.error_after);
  if (map.unknown_pixels)
    text += fmt::format("; {} pixels have no finite error and get the average", map.unknown_pixels);
  if (map.total <= 0)
    text += options.params.target > 0 && map.limit_met ? "; the target is already reached"
                                                       : "; more samples would not lower the error";
  else if (!map.limit_met)
    text += fmt::format("; the {} is not met, because no pixel gets more than {:.6g} samples (--max-samples)",
                        options.params.target > 0 ? "target" : "budget", options.params.max_samples);
  return text;
}

}  // namespace

std::vector<CLI::Option*> add_sample_map_options(OptionSet& set, SampleMapOptions& o) {
  set.begin_group("Sample map");
  CLI::Option* budget =
      set.add(Changes::Result, "--budget", o.params.budget, "Extra samples per pixel, on average")->check(above_zero());
  set.add(Changes::Result, "--target", o.params.target,
          "Mean relative MSE to reach, in place of a budget; denoise without a sample map reaches it by the fastest "
          "settings")
      ->check(above_zero())
      ->excludes(budget);
  CLI::Option* max_samples =
      set.add(Changes::Result, "--max-samples", o.params.max_samples, "Most extra samples of one pixel")
          ->check(above_zero())
          ->capture_default_str();
  CLI::Option* cost =
      set.add(Changes::Result, "--cost", o.cost,
              "Image of the seconds that a sample takes in each pixel (a render time pass): the budget then counts "
              "samples of average cost")
          ->type_name("FILE");
  CLI::Option* frame = set.add(Changes::Result, "--frame", o.frame,
                               "Frame number to write into the map; a sequence "
                               "writes the number of each frame")
                           ->capture_default_str();
  CLI::Option* seed = set.add(Changes::Result, "--seed", o.seed, "Seed of the next render to write into the map")
                          ->capture_default_str();
  CLI::Option* format =
      set.add_choice(Changes::Result, "--export", o.format, formats(), "Write the map in the format of a renderer");
  return {budget, max_samples, cost, frame, seed, format};
}

void check_sample_map_options(const SampleMapOptions& options) {
  if (options.params.budget <= 0 && options.params.target <= 0)
    throw Error(ExitCode::Usage, "a sample map needs --budget or --target");
  if (options.params.budget > options.params.max_samples)
    throw Error(ExitCode::Usage, fmt::format("--budget {:g} is above --max-samples {:g}", options.params.budget,
                                             options.params.max_samples));
  validate(options.params);
}

std::string make_and_write_sample_map(const std::string& target, const ErrorMap& error, const Image& sample_count,
                                      const MapWindows& windows, const SampleMapOptions& options, Progress& progress) {
  Image cost;
  if (!options.cost.empty()) {
    require_cost(options.cost, error.relative_mse.width(), error.relative_mse.height());
    cost = read_cost(options.cost);
  }
  const SampleMap map = make_sample_map(error, sample_count, cost, options.params, progress);
  write_sample_map(target, map, windows, {options.params.budget, options.params.target, options.frame, options.seed},
                   options.format);
  std::string text = summary(map, options) + usage_of(map, options.format);
  if (sample_count.empty())
    text += fmt::format("; the file contains no sample count, {:g} samples per pixel are assumed (--samples sets it)",
                        options.params.assumed_samples);
  return text;
}

}  // namespace polyrecon
