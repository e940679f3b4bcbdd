#include "pipeline/params.h"

#include "core/error.h"

namespace polyrecon {

void validate(const Params& params) {
  if (params.stages < 1 || params.stages > 4) throw Error(ExitCode::Usage, "stages must be 1 to 4");
  if (params.max_order < 0 || params.max_order > 4) throw Error(ExitCode::Usage, "the order must be 0 to 4");
}

}  // namespace polyrecon
