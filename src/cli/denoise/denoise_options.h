#pragma once

#include <CLI/CLI.hpp>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "cli/common/progress_output.h"
#include "cli/common/sample_map_options.h"
#include "polyrecon/params.h"
#include "polyrecon/read_frame.h"

namespace polyrecon {

/// What the command line of `denoise` says.
struct DenoiseOptions {
  std::vector<std::string> inputs;
  std::string output, error_map, order_map, sample_map, report;
  std::optional<int> frame_radius;  ///< As given; frame_radius_of() is what holds.
  std::string frames;               ///< "1-10,20-40x2"; empty: every frame that is there.
  std::vector<std::string> roles;   ///< "role=LAYER"
  ReadOptions read;
  Quality quality = Quality::Standard;
  std::optional<int> stages, order;  ///< In place of what the quality says.
  std::optional<std::size_t> max_memory;
  bool alpha = false;
  std::string steps;       ///< "auto", "all" or a list.
  double time_budget = 0;  ///< Seconds for a whole frame; 0: no limit.
  SampleMapOptions sampling;
  bool sampling_given = false, settings_given = false;
  bool keep_noisy = false, quiet = false;
  bool strict = false, skip_existing = false, dry_run = false;
  double wait = 0;  ///< Seconds that an input may stay unreadable without change.
  int threads = 0;
  ProgressStyle progress = ProgressStyle::Auto;
};

/// Adds all options of the command.
void add_denoise_options(CLI::App& app, DenoiseOptions& options);

/// The reconstruction's parameters that the options ask for.
Params params_of(const DenoiseOptions& options);

/// Frames before and after that join: unless given 2 in a sequence, and none for a file on its own.
int frame_radius_of(const DenoiseOptions& options);

/// Whether the settings are to be chosen for the frame: by --time-budget, or by --target without a sample map.
bool wants_plan(const DenoiseOptions& options);

/// params with everything that the options ask for beside the choice of quality, stages and order.
Params with_options(Params params, const DenoiseOptions& options);

/// What the result depends on, in the words of the command line; goes into the file and the report.
std::string settings_text(const DenoiseOptions& options);

}  // namespace polyrecon
