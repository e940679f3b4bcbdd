#include "cli/common/display_options.h"

namespace polyrecon {

void add_display_options(CLI::App& app, DisplayParams& display) {
  app.add_option("--view", display.view, "View transform: Standard, Filmic, or a view of the configuration in $OCIO")
      ->type_name("NAME");
  app.add_option("--exposure", display.exposure, "Exposure correction in stops; negative values darken the picture")
      ->check(CLI::Range(-64.0, 64.0))
      ->type_name("STOPS");
}

}  // namespace polyrecon
