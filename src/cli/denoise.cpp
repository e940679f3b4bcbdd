#include <memory>

#include "cli/checks.h"
#include "cli/commands.h"
#include "cli/denoise_frame.h"
#include "cli/denoise_options.h"
#include "core/error.h"
#include "core/parallel.h"
#include "io/exr_file.h"

namespace polyrecon {
namespace {

/// Everything that can be refused without reading the input.
void check(const DenoiseOptions& o) {
  validate(params_of(o));
  if (o.sample_map.empty() && o.sampling_given)
    throw Error(ExitCode::Usage, "--budget, --target, --export and the like need --sample-map");
  if (!o.sample_map.empty()) check_sample_map_options(o.sampling);
  require_readable(o.input);
  require_outputs({o.input, o.sampling.cost}, {{"-o", o.output},
                                               {"--error-map", o.error_map},
                                               {"--order-map", o.order_map},
                                               {"--sample-map", o.sample_map},
                                               {"--report", o.report}});
}

void run(DenoiseOptions o) {
  for (const std::string& role : o.roles) o.read.map.push_back(parse_mapping(role));
  check(o);
  set_thread_limit(o.threads);
  set_codec_threads(o.threads > 0 ? o.threads : processors());
  o.read.limits.max_bytes = params_of(o).max_memory;
  const auto progress = make_progress(o.quiet ? ProgressStyle::None : o.progress);
  const FrameFiles files{o.input, o.output, o.error_map, o.order_map, o.sample_map, o.report};
  denoise_frame(files, load_frame(o.input, o), o, *progress);
}

}  // namespace

void setup_denoise(CLI::App& app, Command& chosen) {
  const auto o = std::make_shared<DenoiseOptions>();
  CLI::App* sub = app.add_subcommand("denoise", "Rebuilds a clean image from a noisy render and its feature passes");
  add_denoise_options(*sub, *o);
  sub->footer(
      "Examples:\n"
      "  polyrecon denoise -i render.exr -o clean.exr\n"
      "  polyrecon denoise -i render.exr -o clean.exr --error-map error.exr --report report.json\n"
      "  polyrecon denoise -i render.exr -o clean.exr --sample-map samples.exr --budget 32\n"
      "  polyrecon denoise -i render.exr -o clean.exr --aov 'Diffuse Direct' --aov 'Glossy Direct' --quality best\n"
      "  polyrecon denoise -i render.exr -o clean.exr --map albedo=ViewLayer.MyAlbedo --progress json");
  sub->callback([sub, o, &chosen] {
    o->sampling_given = any_sample_map_option(*sub);
    chosen = [o] { run(*o); };
  });
}

}  // namespace polyrecon
