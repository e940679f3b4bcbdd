#pragma once

#include "cli/common/option_set.h"
#include "denoisers/denoisers.h"

namespace polyrecon {

/// Adds the options that say where a denoiser is found and what runs it.
void add_denoiser_options(OptionSet& set, DenoiserOptions& options);

}  // namespace polyrecon
