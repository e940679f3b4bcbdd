#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "pipeline/params.h"

namespace polyrecon {

/// Adds --effects to app; text is what was given.
CLI::Option* add_effects_option(CLI::App& app, std::string& text);

/// "auto" (or nothing), "all", or a list of effects of which only these run: normal, albedo, depth, visibility,
/// cleaning, outliers, levels, stages. Throws Error{Usage} naming an unknown one.
void apply_effects(const std::string& text, Params& params);

}  // namespace polyrecon
