#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "cli/common/map_files.h"
#include "polyrecon/progress.h"
#include "polyrecon/sample_map.h"

namespace polyrecon {

/// The options of a sample map that `denoise` and `samplemap` share.
struct SampleMapOptions {
  SampleMapParams params;
  std::string cost;  ///< Image file with the cost of a sample per pixel.
  SampleMapFormat format = SampleMapFormat::Polyrecon;
  int frame = 0;
  int seed = 0;
};

/// Adds --budget, --target, --max-samples, --cost, --frame, --seed and --export.
void add_sample_map_options(CLI::App& app, SampleMapOptions& options);

/// Whether any option that only makes sense with a sample map was given (--target makes sense without).
bool any_sample_map_option(const CLI::App& app);

/// The options that the map depends on, in the words of the command line, each after a blank.
std::string sample_map_settings(const SampleMapOptions& options);

/// Throws Error{Usage} for values that contradict each other and Error{Missing} where the cost file is not there.
void check_sample_map_options(const SampleMapOptions& options);

/// Makes the map, writes it to target and returns one line that says what it holds.
std::string make_and_write_sample_map(const std::string& target, const ErrorMap& error, const Image& sample_count,
                                      const MapWindows& windows, const SampleMapOptions& options, Progress& progress);

}  // namespace polyrecon
