#include "cli/denoise/denoise_options.h"

#include <fmt/format.h>

#include <map>

#include "cli/common/choice.h"
#include "cli/common/read_limits.h"
#include "cli/common/steps_option.h"
#include "cli/denoise/frame_files.h"

namespace polyrecon {
namespace {

const std::map<std::string, Quality> qualities{
    {"draft", Quality::Draft}, {"standard", Quality::Standard}, {"best", Quality::Best}};
const std::map<std::string, VarianceKind> variance_kinds{{"auto", VarianceKind::Auto},
                                                         {"mean", VarianceKind::Mean},
                                                         {"sample", VarianceKind::Sample},
                                                         {"moment", VarianceKind::SecondMoment}};
const std::map<std::string, ProgressStyle> progress_styles{{"none", ProgressStyle::None},
                                                           {"bar", ProgressStyle::Bar},
                                                           {"json", ProgressStyle::Json},
                                                           {"openjd", ProgressStyle::OpenJd}};

template <typename Value>
std::string key_of(const std::map<std::string, Value>& names, Value value) {
  for (const auto& [name, v] : names)
    if (v == value) return name;
  return {};
}

void add_files(CLI::App& app, DenoiseOptions& o) {
  app.add_option("-i,--input", o.inputs,
                 "Noisy render: EXR, or what OpenImageIO reads; a sequence as shot.####.exr or "
                 "shot.%04d.exr, or a list of files")
      ->required()
      ->type_name("FILE");
  app.add_option("-o,--output", o.output, "Clean EXR to write; #### or %04d for a sequence, a folder for a list")
      ->required()
      ->type_name("FILE");
  app.add_option("--error-map", o.error_map, "Write how wrong each pixel may still be")->type_name("FILE");
  app.add_option("--order-map", o.order_map, "Write the polynomial order chosen for each pixel")->type_name("FILE");
  app.add_option("--sample-map", o.sample_map, "Write where the next samples should go")->type_name("FILE");
  app.add_option("--report", o.report, "Write the report as JSON")->type_name("FILE");
}

void add_input_options(CLI::App& app, DenoiseOptions& o) {
  const std::string group = "Input";
  app.add_option("-l,--aov", o.read.aovs, "Denoise this colour layer too, with the beauty's windows (repeatable)")
      ->type_name("LAYER")
      ->expected(1)
      ->take_all()
      ->group(group);
  app.add_option("--map", o.roles, "Give a role to a layer by hand: albedo=ViewLayer.MyAlbedo (repeatable)")
      ->type_name("ROLE=LAYER")
      ->expected(1)
      ->take_all()
      ->group(group);
  app.add_option_function<std::string>(
         "--prior", [&o](const std::string& layer) { o.roles.push_back("prior=" + layer); },
         "Denoised layer, or file, that is taken where it is better: --map prior=LAYER")
      ->type_name("LAYER|FILE")
      ->group(group);
  app.add_option("--view-layer", o.read.view_layer, "View layer to denoise, in place of the first one")
      ->type_name("NAME")
      ->group(group);
  add_choice(app, "--variance-kind", o.read.variance_kind, variance_kinds,
             "What variance layers hold: auto, mean (of the pixel), sample (of one sample), moment (mean square)")
      ->group(group);
  app.add_option("--samples", o.read.samples, "Samples per pixel, where the file does not tell")
      ->check(CLI::PositiveNumber)
      ->group(group);
}

void add_method_options(CLI::App& app, DenoiseOptions& o) {
  const std::string group = "Reconstruction";
  CLI::Option* quality = add_choice(app, "--quality", o.quality, qualities, "draft, standard or best")->group(group);
  CLI::Option* stages =
      app.add_option("--stages", o.stages, "Rounds of error estimation, 1 to 4, in place of what the quality takes")
          ->group(group);
  CLI::Option* order =
      app.add_option("--order", o.order, "Highest polynomial order, 0 to 4, in place of what the quality takes")
          ->group(group);
  app.add_option("--time-budget", o.time_budget,
                 "Seconds that a frame may take with its files: the most accurate settings that are predicted to fit")
      ->check(CLI::PositiveNumber)
      ->type_name("SECONDS")
      ->excludes(quality)
      ->excludes(stages)
      ->excludes(order)
      ->group(group);
  add_steps_option(app, o.steps)->group(group);
  app.add_flag("--alpha", o.alpha, "Denoise alpha too, in place of keeping it")->group(group);
  app.add_flag("--keep-noisy", o.keep_noisy, "Keep what is replaced, under '<layer> Noisy'")->group(group);
}

void add_run_options(CLI::App& app, DenoiseOptions& o) {
  const std::string group = "Run";
  app.add_option("-t,--threads", o.threads, "Threads to use; 0: all processors")
      ->check(CLI::Range(0, 4096))
      ->capture_default_str()
      ->group(group);
  app.add_option("--max-memory", o.max_memory, "Memory to stay within, in bytes or as 512M, 4G")
      ->transform(CLI::AsSizeValue(false).description(""))
      ->type_name("SIZE")
      ->group(group);
  add_choice(app, "--progress", o.progress, progress_styles,
             "none, bar, json (one object per line) or openjd (Open Job Description), on standard error; a bar on a "
             "terminal")
      ->group(group);
  app.add_flag("-q,--quiet", o.quiet, "Print nothing but errors")->group(group);
}

void add_sequence_options(CLI::App& app, DenoiseOptions& o) {
  const std::string group = "Sequences";
  app.add_option("--frames", o.frames, "Frames of a sequence, 1-10,20-40x2; all that are there without it")
      ->check([](const std::string& text) { return std::string(text.empty() ? "is empty" : ""); }, "", "")
      ->type_name("RANGES")
      ->group(group);
  app.add_option(
         "--frame-radius", o.frame_radius,
         "Frames before and after that help each frame of a sequence, along its motion vectors where there are any; 2 "
         "unless given")
      ->check(CLI::Range(0, 8))
      ->type_name("R")
      ->group(group);
  app.add_flag("--skip-existing", o.skip_existing,
               "Leave frames alone whose result was made from the same input, settings and version")
      ->group(group);
  app.add_option("--wait", o.wait, "Seconds to wait for an input that is still being written, from its last change")
      ->check(CLI::NonNegativeNumber)
      ->type_name("SECONDS")
      ->group(group);
  app.add_flag("--strict", o.strict, "Stop at the first frame that is missing or broken")->group(group);
  app.add_flag("--dry-run", o.dry_run, "Say what would be done, and check that the inputs are there")->group(group);
}

}  // namespace

Params params_of(const DenoiseOptions& o) {
  Params params = params_for(o.quality);
  if (o.stages) params.stages = *o.stages;
  if (o.order) params.max_order = *o.order;
  return with_options(params, o);
}

int frame_radius_of(const DenoiseOptions& o) { return o.frame_radius.value_or(is_sequence(o) ? 2 : 0); }

bool wants_plan(const DenoiseOptions& o) {
  return o.time_budget > 0 || (o.sampling.params.target > 0 && o.sample_map.empty());
}

Params with_options(Params params, const DenoiseOptions& o) {
  if (o.max_memory) params.max_memory = *o.max_memory;
  params.reconstruct_alpha = o.alpha;
  apply_steps(o.steps, params);
  params.temporal.radius = frame_radius_of(o);
  return params;
}

std::string settings_text(const DenoiseOptions& o) {
  const Params params = params_of(o);
  std::string text = fmt::format("--quality {} --stages {} --order {} --variance-kind {}", key_of(qualities, o.quality),
                                 params.stages, params.max_order, key_of(variance_kinds, o.read.variance_kind));
  if (params.reconstruct_alpha) text += " --alpha";
  if (!o.steps.empty()) text += " --steps " + o.steps;
  if (o.time_budget > 0) text += fmt::format(" --time-budget {:g}", o.time_budget);
  if (wants_plan(o) && o.sampling.params.target > 0) text += fmt::format(" --target {:g}", o.sampling.params.target);
  if (!o.read.view_layer.empty()) text += " --view-layer '" + o.read.view_layer + "'";
  for (const std::string& aov : o.read.aovs) text += " --aov '" + aov + "'";
  for (const std::string& role : o.roles) text += " --map '" + role + "'";
  if (o.read.samples > 0) text += fmt::format(" --samples {:g}", o.read.samples);
  if (params.temporal.radius > 0) text += fmt::format(" --frame-radius {}", params.temporal.radius);
  if (o.keep_noisy) text += " --keep-noisy";
  if (!o.sample_map.empty()) text += sample_map_settings(o.sampling);
  return text;
}

void add_denoise_options(CLI::App& app, DenoiseOptions& options) {
  add_files(app, options);
  add_input_options(app, options);
  add_sequence_options(app, options);
  add_method_options(app, options);
  add_sample_map_options(app, options.sampling);
  add_run_options(app, options);
  add_read_limits(app, options.read.limits);
}

}  // namespace polyrecon
