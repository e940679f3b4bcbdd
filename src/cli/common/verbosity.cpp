#include "cli/common/verbosity.h"

namespace polyrecon {
namespace {

CLI::Option* quiet_flag(CLI::App& app, Verbosity& verbosity, const std::string& group) {
  return app
      .add_flag_callback(
          "-q,--quiet", [&verbosity] { verbosity = Verbosity::Quiet; }, "Print nothing but errors")
      ->group(group);
}

}  // namespace

void add_quiet(CLI::App& app, Verbosity& verbosity, const std::string& group) { quiet_flag(app, verbosity, group); }

void add_verbosity(CLI::App& app, Verbosity& verbosity, const std::string& group) {
  CLI::Option* quiet = quiet_flag(app, verbosity, group);
  app.add_flag_callback(
         "-v,--verbose", [&verbosity] { verbosity = Verbosity::Full; }, "Print all figures")
      ->group(group)
      ->excludes(quiet);
}

}  // namespace polyrecon
