#pragma once

#include <nlohmann/json.hpp>
#include <vector>

#include "polyrecon/report.h"

// Reports as JSON; docs/reference/report.md describes each key.
namespace polyrecon {

nlohmann::ordered_json decisions_json(const std::vector<Decision>& decisions);

/// The part of a report that does not depend on where the frame came from and where the result goes.
nlohmann::ordered_json report_json(const Report& report);

/// Seconds of all phases together.
double reconstruction_seconds(const Report& report);

/// Pixels per second of all phases together; 0 if they took no time.
double pixels_per_second(const Report& report);

/// after / before - 1 of the sum over RGB.
double energy_change(const Report& report);

}  // namespace polyrecon
