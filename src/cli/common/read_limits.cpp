#include "cli/common/read_limits.h"

namespace polyrecon {

void add_read_limits(CLI::App& app, ReadLimits& limits) {
  const std::string group = "Limits";
  app.add_option("--max-pixels", limits.max_pixels, "Refuse files of which a part has more pixels")
      ->check(CLI::PositiveNumber)
      ->capture_default_str()
      ->group(group);
  app.add_option("--max-channels", limits.max_channels, "Refuse files of more channels")
      ->check(CLI::PositiveNumber)
      ->capture_default_str()
      ->group(group);
}

}  // namespace polyrecon
