#include "cli/common/read_limits.h"

#include "cli/common/numbers.h"

namespace polyrecon {

void add_read_limits(OptionSet& set, ReadLimits& limits) {
  set.begin_group("Limits");
  set.add(Changes::Run, "--max-pixels", limits.max_pixels, "Refuse files with more pixels in a part")
      ->check(above_zero())
      ->capture_default_str();
  set.add(Changes::Run, "--max-channels", limits.max_channels, "Refuse files with more channels")
      ->check(above_zero())
      ->capture_default_str();
}

}  // namespace polyrecon
