#include <fmt/format.h>

#include <cstdio>
#include <exception>
#include <memory>
#include <utility>
#include <vector>

#include "cli/commands.h"
#include "cli/common/checks.h"
#include "cli/denoise/denoise_frame.h"
#include "cli/denoise/denoise_options.h"
#include "cli/denoise/fetch_frame.h"
#include "cli/denoise/frame_files.h"
#include "cli/denoise/sequence.h"
#include "core/parallel.h"
#include "io/exr/file.h"
#include "pipeline/memory.h"
#include "polyrecon/error.h"

namespace polyrecon {
namespace {

/// Everything that can be refused without reading an input.
void check(const DenoiseOptions& o, const std::vector<FrameFiles>& frames) {
  validate(params_of(o));
  if (o.sample_map.empty() && o.sampling_given)
    throw Error(ExitCode::Usage, "--budget, --export and the like need --sample-map");
  if (wants_plan(o) && o.time_budget <= 0 && o.settings_given)
    throw Error(ExitCode::Usage, "--target chooses the settings: leave --quality, --stages and --order away");
  if (frame_radius_of(o) > 0 && !is_sequence(o))
    throw Error(ExitCode::Usage, "--frame-radius needs a sequence: -i with #### or %04d in its name, or several files");
  if (!o.sample_map.empty()) check_sample_map_options(o.sampling);
  std::vector<std::string> outputs;
  for (const FrameFiles& files : frames) {
    require_different_files({files.input, o.sampling.cost}, {{"-o", files.output},
                                                             {"--error-map", files.error_map},
                                                             {"--order-map", files.order_map},
                                                             {"--sample-map", files.sample_map},
                                                             {"--report", files.report}});
    outputs.insert(outputs.end(), {files.output, files.error_map, files.order_map, files.sample_map, files.report});
  }
  if (!is_sequence(o) && o.wait <= 0) require_readable(frames.front().input);
  require_writable(outputs);
}

void work(const std::vector<FrameFiles>& frames, const DenoiseOptions& o, RunProgress& progress) {
  if (o.dry_run) return show_dry_run(frames, o);
  if (is_sequence(o)) return run_sequence(frames, o, progress);
  progress.frame(frames.front().label(), 0, 1);
  auto loaded = FrameFetcher(o, [&] { return progress.cancelled(); }).fetch(frames.front());
  if (loaded)
    denoise_frame(frames.front(), std::move(*loaded), o, progress);
  else if (!o.quiet)
    std::fputs(fmt::format("{}: finished already\n", o.output).c_str(), stdout);
  progress.frame("", 1, 1);
}

void run(DenoiseOptions o) {
  for (const std::string& role : o.roles) o.read.map.push_back(parse_mapping(role));
  o.read.motion = frame_radius_of(o) > 0;
  o.read.accept = [o](const std::string& path, FrameShape shape) {
    const Params params = params_of(o);
    if (is_sequence(o))
      shape.beside = channels_ahead(shape, params) + neighbours_channels(shape, 2 * params.temporal.radius);
    require_memory(path, shape, params);
  };
  const auto progress = make_progress(o.quiet ? ProgressStyle::None : o.progress);
  try {
    const std::vector<FrameFiles> frames = list_frames(o);
    check(o, frames);
    set_thread_limit(o.threads);
    set_codec_threads(o.threads > 0 ? o.threads : processors());
    work(frames, o, *progress);
  } catch (const std::exception& error) {
    progress->failed(error.what());
    throw;
  }
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
      "  polyrecon denoise -i render.exr -o clean.exr --time-budget 10\n"
      "  polyrecon denoise -i render.exr -o clean.exr --target 0.002\n"
      "  polyrecon denoise -i render.exr -o clean.exr --aov 'Diffuse Direct' --aov 'Glossy Direct' --quality best\n"
      "  polyrecon denoise -i shot.####.exr -o clean/shot.####.exr --frames 1-10,20-40x2 --skip-existing\n"
      "  polyrecon denoise -i render.exr -o clean.exr --map albedo=ViewLayer.MyAlbedo --progress json");
  sub->callback([sub, o, &chosen] {
    o->sampling_given = any_sample_map_option(*sub);
    o->settings_given = sub->count("--quality") + sub->count("--stages") + sub->count("--order") > 0;
    chosen = [o] { run(*o); };
  });
}

}  // namespace polyrecon
