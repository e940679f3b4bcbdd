#pragma once

#include <string>

#include "cli/common/option_set.h"
#include "polyrecon/encoding.h"

namespace polyrecon {

/// Adds --compression and --dwa-level. by_default: what is written without --compression, in words.
void add_encoding_options(OptionSet& set, Encoding& encoding, const std::string& by_default);

/// Throws Error{Usage} where a level is given for a compression that has none.
void check_encoding(const Encoding& encoding);

}  // namespace polyrecon
