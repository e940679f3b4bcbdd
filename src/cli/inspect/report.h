#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "io/inspect.h"
#include "polyrecon/report.h"

namespace polyrecon {

/// What `inspect` tells about a file.
struct InspectReport {
  Inspection file;
  std::vector<Decision> steps;  ///< What denoise would decide; empty for a file without beauty.
};

/// The report as lines of text.
std::string inspect_text(const InspectReport& report);

/// The report as JSON (docs/reference/inspect_json.md).
nlohmann::ordered_json inspect_json(const InspectReport& report);

}  // namespace polyrecon
