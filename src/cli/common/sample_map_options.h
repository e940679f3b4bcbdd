#pragma once

#include <string>
#include <vector>

#include "cli/common/map_files.h"
#include "cli/common/option_set.h"
#include "polyrecon/progress.h"
#include "polyrecon/sample_map.h"

namespace polyrecon {

/// The options of a sample map that `denoise` and `samplemap` share.
struct SampleMapOptions {
  SampleMapParams params;
  std::string cost;  ///< Image file with the cost of a sample in each pixel; empty: all cost the same.
  const SampleMapFormat* format = nullptr;  ///< The format of a renderer; nullptr: samples.Y and importance.Y.
  int frame = 0;                            ///< Written into the map.
  int seed = 0;                             ///< Seed of the next render, written into the map.
};

/// Adds --budget, --target, --max-samples, --cost, --frame, --seed and --export. Returns those that have no meaning
/// without a sample map: all but --target.
std::vector<CLI::Option*> add_sample_map_options(OptionSet& set, SampleMapOptions& options);

/// Throws Error{Usage} for values that contradict each other.
void check_sample_map_options(const SampleMapOptions& options);

/// Makes the map, writes it to target and returns one line about its samples and errors. Throws Error{Missing} where
/// the file of costs does not exist.
std::string make_and_write_sample_map(const std::string& target, const ErrorMap& error, const Image& sample_count,
                                      const MapWindows& windows, const SampleMapOptions& options, Progress& progress);

}  // namespace polyrecon
