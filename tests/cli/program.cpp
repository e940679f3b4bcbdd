#include "cli/program.h"

namespace polyrecon::testing {

const char* program_path() { return POLYRECON_PROGRAM; }

const char* failing_calls_path() { return POLYRECON_FAILING_CALLS; }

}  // namespace polyrecon::testing
