#pragma once

#include <string>

#include "polyrecon/report.h"

namespace polyrecon {

/// "yes: REASON" or "no: REASON", and the seconds that were saved.
std::string decision_text(const Decision& decision);

}  // namespace polyrecon
