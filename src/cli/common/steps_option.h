#pragma once

#include <string>

#include "cli/common/option_set.h"
#include "polyrecon/params.h"

namespace polyrecon {

/// Adds --steps, and its former name --effects as a hidden alias.
void add_steps_option(OptionSet& set, std::string& text);

/// Sets params from "auto" (or nothing), "all", or a list of steps of which only these run: the features of
/// polyrecon/roles.h by name, prefilter, fireflies, levels, stages. Throws Error{Usage} naming an unknown step.
void apply_steps(const std::string& text, Params& params);

}  // namespace polyrecon
