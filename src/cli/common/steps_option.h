#pragma once

#include <string>

#include "cli/common/option_set.h"
#include "polyrecon/params.h"

namespace polyrecon {

/// Adds --steps, and its former name --effects as a hidden alias.
void add_steps_option(OptionSet& set, std::string& text);

/// The choice of --steps.
struct StepsChoice {
  Steps steps;
  bool levels = true, stages = true;  ///< False: only one level, only one stage.

  /// The parameters with this choice.
  Params applied_to(Params params) const;
};

/// Reads "auto" (or nothing), "all", or a list of steps of which only these run: the features of polyrecon/roles.h by
/// name, prefilter, fireflies, levels, stages. Throws Error{Usage} naming an unknown step.
StepsChoice parse_steps(const std::string& text);

}  // namespace polyrecon
