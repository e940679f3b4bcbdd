#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "polyrecon/params.h"

namespace polyrecon {

/// Adds --steps to app; text is what was given.
CLI::Option* add_steps_option(CLI::App& app, std::string& text);

/// Sets params from "auto" (or nothing), "all", or a list of steps of which only these run: the features of
/// polyrecon/roles.h by name, prefilter, fireflies, levels, stages. Throws Error{Usage} naming an unknown step.
void apply_steps(const std::string& text, Params& params);

}  // namespace polyrecon
