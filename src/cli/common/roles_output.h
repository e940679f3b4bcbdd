#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "polyrecon/read_frame.h"

namespace polyrecon {

/// The layers in use and their roles: a line each, and as JSON (docs/reference/report.md).
std::string roles_text(const FrameSource& source);
nlohmann::ordered_json roles_json(const FrameSource& source);

}  // namespace polyrecon
