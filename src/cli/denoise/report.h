#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "cli/common/verbosity.h"
#include "cli/denoise/load_frame.h"
#include "cli/denoise/settings_choice.h"
#include "io/layers/pass_advice.h"
#include "polyrecon/read_frame.h"
#include "polyrecon/report.h"

namespace polyrecon {

/// Everything that is reported about a denoised picture.
struct RunReport {
  PictureChoice picture;
  std::string title;  ///< Name of the picture where the file has several.
  std::string version, input, output, settings;
  std::vector<std::string> notes;  ///< Notes from reading, writing and the sample map.
  double seconds = 0;              ///< Time from the start to the last file written.
  double read_seconds = 0, write_seconds = 0;
  std::size_t peak_memory = 0;  ///< Peak of the process, in bytes.
  Report reconstruction;
  double noise_before = 0;  ///< Mean over the frame of relnoise.Y; NaN if unknown.
  std::vector<PassAdvice> advice;
  std::vector<std::string> missed;       ///< Limits of --time-budget and --target that were missed.
  std::optional<ChosenSettings> chosen;  ///< Set if --time-budget or --target chose the settings.
};

/// Peak resident memory of this process in bytes.
std::size_t peak_memory();

/// Text about the input, printed before the work: a line, or with Verbosity::Full the roles of all layers. picture: its
/// name in a file of several.
std::string input_text(const ReadResult& in, const std::string& picture, Verbosity verbosity);

/// Text about the work, advice and notes: a line each, or with Verbosity::Full the table of all figures. advice: the
/// lines of the run's advice that are printed.
std::string report_text(const RunReport& run, const std::vector<std::string>& advice, Verbosity verbosity);

/// The same as JSON (docs/reference/report.md).
nlohmann::ordered_json report_json(const RunReport& run, const FrameSource& source);

}  // namespace polyrecon
