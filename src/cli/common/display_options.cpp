#include "cli/common/display_options.h"

#include "cli/common/numbers.h"

namespace polyrecon {

void add_display_options(CLI::App& app, DisplayParams& display) {
  app.add_option("--view", display.view, "View transform: Standard, Filmic, or a view of the configuration in $OCIO")
      ->type_name("NAME");
  app.add_option("--exposure", display.exposure, "Exposure correction in stops; negative values darken the picture")
      ->check(from_to(-64, 64))
      ->type_name("STOPS");
}

void add_page_size(CLI::App& app, std::size_t& bytes) {
  app.add_option("--max-size", bytes,
                 "Largest size of the pictures in the page, in bytes or as 200M, 1G; default: 512M")
      ->transform(CLI::AsSizeValue(false).description(""))
      ->type_name("SIZE");
}

}  // namespace polyrecon
