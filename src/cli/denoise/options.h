#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "cli/common/denoiser_options.h"
#include "cli/common/memory_limit.h"
#include "cli/common/option_set.h"
#include "cli/common/progress_output.h"
#include "cli/common/sample_map_options.h"
#include "cli/common/verbosity.h"
#include "cli/denoise/contents_option.h"
#include "cli/denoise/frame_files.h"
#include "polyrecon/encoding.h"
#include "polyrecon/params.h"
#include "polyrecon/read_frame.h"

namespace polyrecon {

/// How `denoise` runs, whatever it computes.
struct RunOptions {
  bool skip_existing = false;  ///< Skip frames whose outputs were made from the same input by the same settings.
  bool strict = false;         ///< The first frame that fails ends the run.
  bool dry_run = false;        ///< Only list what would be done.
  bool overwrite = false;
  bool miss_fails = false;  ///< A missed time budget or target ends with exit_code_missed.
  Verbosity verbosity = Verbosity::Short;
  double wait = 0;  ///< Seconds that an input may stay unreadable without change.
  int threads = 0;  ///< 0: as many as there are processors.
  ProgressStyle progress = ProgressStyle::Bar;

  /// Whether outputs that exist may be replaced: --skip-existing keeps what is finished and replaces the rest.
  bool may_replace() const { return overwrite || skip_existing; }
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
  bool alpha = false;
  std::string contents = default_contents;
  Encoding encoding;
  std::optional<int> frame_radius;
  std::size_t max_memory = default_memory();
  SampleMapOptions sample_map;
  RunOptions run;
};

/// The name of each quality on the command line, the fastest first.
const Choices<Quality>& quality_names();

/// Adds all options of the command to `set`.
void add_denoise_options(OptionSet& set, DenoiseOptions& options);

}  // namespace polyrecon
