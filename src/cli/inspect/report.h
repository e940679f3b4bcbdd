#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "io/inspect.h"
#include "io/layers/pass_advice.h"
#include "polyrecon/report.h"

namespace polyrecon {

/// A denoiser that can make a prior.
struct FoundDenoiser {
  std::string option;   ///< "oidn"
  std::string name;     ///< With version and device; empty if it cannot be used.
  std::string place;    ///< File that it was loaded from.
  std::string problem;  ///< Why it cannot be used.
};

/// The findings of `inspect` about a file.
struct InspectReport {
  Inspection file;
  std::vector<Decision> steps;             ///< Decisions that denoise would take; empty for a file without beauty.
  std::vector<FoundDenoiser> denoisers{};  ///< Those that --prior takes by name.
  std::vector<PassAdvice> advice{};
};

/// The report as lines of text.
std::string inspect_text(const InspectReport& report);

/// The report as JSON (docs/reference/inspect_json.md).
nlohmann::ordered_json inspect_json(const InspectReport& report);

}  // namespace polyrecon
