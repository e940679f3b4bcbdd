#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "cli/denoise/planning.h"
#include "polyrecon/read_frame.h"
#include "polyrecon/report.h"

namespace polyrecon {

/// All that a run of `denoise` tells: the reconstruction's own report and what surrounds it.
struct RunReport {
  std::string version, input, output, settings;
  std::vector<std::string> notes;  ///< Of reading, writing and the sample map.
  double seconds = 0;              ///< From start to the last file written.
  double read_seconds = 0, write_seconds = 0;
  std::size_t peak_memory = 0;  ///< Bytes, of the process.
  Report reconstruction;
  std::optional<FramePlan> plan;  ///< Where the settings were chosen for the frame.
};

/// Peak resident memory of this process in bytes.
std::size_t peak_memory();

/// Which layer plays which role, a line each.
std::string roles_text(const FrameSource& source);
nlohmann::ordered_json roles_json(const FrameSource& source);

/// The table at the end of a run.
std::string report_text(const RunReport& run);

/// "yes: REASON" or "no: REASON", with the seconds that it saved.
std::string decision_text(const Decision& decision);
nlohmann::ordered_json decisions_json(const std::vector<Decision>& decisions);

/// The same with stable keys; docs/reference/report.md lists them.
nlohmann::ordered_json report_json(const RunReport& run, const FrameSource& source);

}  // namespace polyrecon
