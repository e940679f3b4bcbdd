#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "cli/common/denoiser_options.h"
#include "cli/common/option_set.h"
#include "cli/common/progress_output.h"
#include "cli/common/sample_map_options.h"
#include "cli/denoise/frame_files.h"
#include "polyrecon/params.h"
#include "polyrecon/read_frame.h"

namespace polyrecon {

/// How `denoise` runs, whatever it computes.
struct RunOptions {
  bool skip_existing = false;  ///< Skip frames whose outputs were made from the same input by the same settings.
  bool strict = false;         ///< The first frame that fails ends the run.
  bool dry_run = false;        ///< Only list what would be done.
  bool quiet = false;
  double wait = 0;  ///< Seconds that an input may stay unreadable without change.
  int threads = 0;  ///< 0: as many as there are processors.
  ProgressStyle progress = ProgressStyle::Auto;
};

/// The command line of `denoise` as it was given. make_job turns it into the work to do.
struct DenoiseOptions {
  std::vector<std::string> inputs;  ///< One file, one pattern, or several files.
  OutputPaths outputs;              ///< Files, or patterns and folders where there are several inputs.
  std::string frames;               ///< "1-10,20-40x2"; empty: all frames of the pattern that exist.
  std::vector<std::string> roles;   ///< "role=LAYER": those of --map, then those of --prior, whatever the order typed.
  DenoiserOptions denoiser;
  ReadOptions read;
  std::optional<Quality> quality;
  std::optional<int> stages, order;
  std::string steps = "auto";
  double time_budget = 0;  ///< Seconds for a whole frame; 0: no limit.
  bool alpha = false, keep_noisy = false;
  std::optional<int> frame_radius;
  std::optional<std::size_t> max_memory;
  SampleMapOptions sample_map;
  RunOptions run;
};

/// The name of each quality on the command line.
const std::map<std::string, Quality>& quality_names();

/// Adds all options of the command to `set`.
void add_denoise_options(OptionSet& set, DenoiseOptions& options);

}  // namespace polyrecon
