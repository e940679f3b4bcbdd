#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "cli/common/frame_names.h"
#include "cli/common/option_set.h"
#include "cli/common/sample_map_options.h"
#include "cli/denoise/frame_files.h"
#include "cli/denoise/options.h"
#include "denoisers/denoisers.h"
#include "polyrecon/params.h"
#include "polyrecon/read_frame.h"

namespace polyrecon {

/// Limits for which a pilot run chooses the settings of each frame; 0: no limit.
struct FrameLimits {
  double seconds = 0;       ///< For a whole frame, reading and writing included.
  double relative_mse = 0;  ///< Largest mean relative MSE.

  /// The limits that are left after so many seconds. At least a millisecond is left, which selects the fastest
  /// settings.
  FrameLimits after(double spent) const;
};

/// The work that a command line of `denoise` requests. Everything is decided, except the settings that a pilot chooses
/// for each frame within the limits.
struct Job {
  std::vector<FrameFiles> frames;
  bool is_sequence = false;  ///< A frame of a sequence that fails does not end the run.
  std::vector<int> gaps;     ///< Numbers that no file has, between those that were found; empty with --frames.
  ReadOptions read;
  std::vector<std::optional<FramePattern>> map_patterns;  ///< Those of the files in read.map, in its order.
  std::optional<FramePattern> cost_pattern;               ///< That of the sample map's file of costs.
  Params params;  ///< If a pilot chooses the settings: those of standard quality.
  std::optional<FrameLimits> limits;
  std::vector<Params> presets;  ///< Settings that a pilot chooses from, as presets(); empty without limits.
  std::optional<SampleMapOptions> sample_map;
  MakeDenoiser make_denoiser = nullptr;  ///< Null: the prior is a layer of the file, if it has one.
  DenoiserOptions denoiser_options;
  std::shared_ptr<const Denoiser> denoiser;  ///< Null before with_denoiser, and where none is wanted.
  ResultContents contents;
  Encoding encoding;
  RunOptions run;
  std::string settings;  ///< Identity of the settings, see settings_of.
};

/// Resolves the options that were parsed by `set`. Throws Error{Usage} where they contradict each other, and as
/// list_frames.
Job make_job(const DenoiseOptions& options, const OptionSet& set);

/// Throws Error{Usage} where the options contradict each other; looks at no file.
void check_options(const DenoiseOptions& options);

/// Throws Error{Usage}, Error{Missing} or Error{CannotWrite} where the files of a job cannot be used: an output that is
/// an input too, an input that does not exist, a folder that cannot be written to. Reads no pixel.
void check_files(const Job& job);

/// The job with its denoiser, if it wants one, loaded. Throws Error{Missing} where it is not installed. Call it once
/// the number of threads is set.
Job with_denoiser(Job job);

/// How the frame of this number is read: in the names of files that options name, the number replaces ####.
ReadOptions read_options_for(const Job& job, std::optional<int> frame);

/// The options of a frame's sample map; the job must have some. Its number is written into the map, and replaces ####
/// in the name of the file of costs.
SampleMapOptions sample_map_for(const Job& job, const FrameFiles& files);

/// Notes on files that options name without a number, if one of them is used for this frame of a sequence.
std::vector<std::string> fixed_file_notes(const Job& job, const FrameSource& source);

/// The settings that the result of a frame depends on in addition to its input, as options of the command line. The
/// result and the report contain it; --skip-existing compares it.
std::string settings_of(const Job& job, const FrameFiles& files);

}  // namespace polyrecon
