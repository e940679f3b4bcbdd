#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "polyrecon/report.h"

namespace polyrecon {

/// "yes: REASON" or "no: REASON", and the seconds that were saved.
std::string decision_text(const Decision& decision);

/// All decisions as JSON (docs/reference/report.md).
nlohmann::ordered_json decisions_json(const std::vector<Decision>& decisions);

}  // namespace polyrecon
