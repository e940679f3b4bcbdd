#include "cli/common/display_options.h"

namespace polyrecon {

void add_display_options(CLI::App& app, DisplayParams& display) {
  app.add_option("--view", display.view, "View of the display: Standard, Filmic, or one of $OCIO's")->type_name("NAME");
  app.add_option("--exposure", display.exposure, "Brighter (or darker) by so many stops")
      ->check(CLI::Range(-64.0, 64.0))
      ->type_name("STOPS");
}

}  // namespace polyrecon
