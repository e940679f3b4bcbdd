#pragma once

#include <CLI/CLI.hpp>

#include "io/pictures/color.h"

namespace polyrecon {

/// Adds --view and --exposure.
void add_display_options(CLI::App& app, DisplayParams& display);

}  // namespace polyrecon
