#include <fmt/format.h>

#include <cstdio>
#include <memory>
#include <string>

#include "cli/commands.h"
#include "cli/common/checks.h"
#include "cli/common/map_files.h"
#include "cli/common/memory_limit.h"
#include "cli/common/numbers.h"
#include "cli/common/option_set.h"
#include "cli/common/printed_text.h"
#include "cli/common/progress_output.h"
#include "cli/common/sample_map_options.h"
#include "cli/common/verbosity.h"

namespace polyrecon {
namespace {

struct SamplemapOptions {
  std::string error_map, output;
  SampleMapOptions map;
  double samples = 0;  ///< Samples per pixel so far; 0: those in the error map.
  bool overwrite = false;
  Verbosity verbosity = Verbosity::Short;
  std::size_t max_memory = default_memory();
};

void check(const SamplemapOptions& o) {
  check_sample_map_options(o.map);
  require_endings({{"-o", o.output}});
}

void run(const SamplemapOptions& o) {
  limit_memory(o.max_memory);
  check(o);
  require_readable(o.error_map);
  if (!o.map.cost.empty()) require_readable(o.map.cost);
  require_outputs({o.error_map, o.map.cost}, {{"-o", o.output}}, o.overwrite);
  ErrorMapFile error = read_error_map(o.error_map);
  const Image& map = error.map.relative_mse;
  if (error.sample_count.empty() && o.samples > 0)
    error.sample_count = Image(map.width(), map.height(), 1, static_cast<Real>(o.samples));
  const auto progress = make_progress(ProgressStyle::None);
  const std::string text =
      make_and_write_sample_map(o.output, error.map, error.sample_count, error.windows, o.map, *progress);
  if (o.verbosity != Verbosity::Quiet) std::fputs(text_line("{}: {}", o.output, text).c_str(), stdout);
}

}  // namespace

void setup_samplemap(CLI::App& app, Command& chosen) {
  const auto o = std::make_shared<SamplemapOptions>();
  CLI::App* sub =
      app.add_subcommand("samplemap", "Computes from an error map how many more samples each pixel should get");
  sub->add_option("-e,--error-map", o->error_map, "Error map that denoise wrote")->required()->type_name("FILE");
  sub->add_option("-o,--output", o->output, "Sample map to write")->required()->type_name("FILE");
  sub->add_option("--samples", o->samples, "Samples per pixel so far, if the error map does not contain them")
      ->check(above_zero());
  add_overwrite(*sub, o->overwrite);
  add_quiet(*sub, o->verbosity);
  add_memory_limit(*sub, o->max_memory);
  OptionSet set(*sub);
  add_sample_map_options(set, o->map);
  sub->footer(
      "Examples:\n"
      "  polyrecon samplemap --error-map error.exr --budget 32 -o samples.exr\n"
      "  polyrecon samplemap --error-map error.exr --target 0.002 -o samples.exr\n"
      "  polyrecon samplemap --error-map error.exr --budget 16 --export appleseed -o samples.exr");
  set_callback(*sub, o, run, check, chosen);
}

}  // namespace polyrecon
