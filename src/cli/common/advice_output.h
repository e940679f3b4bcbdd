#pragma once

#include <nlohmann/json.hpp>
#include <vector>

#include "io/layers/pass_advice.h"

namespace polyrecon {

/// Advice about passes as JSON (docs/reference/report.md).
nlohmann::ordered_json advice_json(const std::vector<PassAdvice>& advice);

}  // namespace polyrecon
