#include "cli/denoise/options.h"

#include <fmt/format.h>

#include "cli/common/encoding_options.h"
#include "cli/common/numbers.h"
#include "cli/common/read_limits.h"
#include "cli/common/steps_option.h"
#include "cli/denoise/frame_files.h"

namespace polyrecon {
namespace {

const Choices<VarianceKind> variance_kinds{{"auto", VarianceKind::Auto},
                                           {"mean", VarianceKind::Mean},
                                           {"sample", VarianceKind::Sample},
                                           {"moment", VarianceKind::SecondMoment}};
const Choices<Wrap> wraps{{"auto", Wrap::Auto}, {"none", Wrap::None}, {"x", Wrap::X}};
const Choices<bool> what_a_miss_does{{"keep", false}, {"fail", true}};
const Choices<ProgressStyle> progress_styles{{"bar", ProgressStyle::Bar},
                                             {"none", ProgressStyle::None},
                                             {"json", ProgressStyle::Json},
                                             {"openjd", ProgressStyle::OpenJd}};

/// Returns --sample-map, which other options need.
CLI::Option* add_files(OptionSet& set, DenoiseOptions& o) {
  set.add(Changes::Run, "-i,--input", o.inputs,
          "Noisy render: EXR, PFM, Radiance HDR or TIFF; a sequence as shot.####.exr or shot.%04d.exr, a "
          "list of files, or a folder, of which all renders are taken")
      ->required()
      ->type_name("FILE");
  set.add(Changes::Run, "-o,--output", o.outputs.picture,
          "Denoised EXR to write; #### or %04d for a sequence; a folder takes the inputs' names; default: "
          "NAME_denoised.exr next to the input")
      ->type_name("FILE");
  set.add(Changes::Run, "--error-map", o.outputs.error_map, "Write the estimated error of each pixel")
      ->type_name("FILE");
  set.add(Changes::Run, "--order-map", o.outputs.order_map, "Write the polynomial order chosen for each pixel")
      ->type_name("FILE");
  CLI::Option* sample_map =
      set.add(Changes::Run, "--sample-map", o.outputs.sample_map, "Write how many more samples each pixel should get")
          ->type_name("FILE");
  set.add(Changes::Run, "--report", o.outputs.report, "Write the report as JSON")->type_name("FILE");
  set.add_flag(Changes::Run, "--overwrite", o.run.overwrite, overwrite_help);
  return sample_map;
}

void add_input_options(OptionSet& set, DenoiseOptions& o) {
  set.begin_group("Input");
  set.add(Changes::Result, "-l,--aov", o.read.aovs,
          "Denoise these colour layers too: names, a,b, patterns as 'Glossy*', or all for all light AOVs; with the "
          "windows of the beauty, or with windows of its own where one is no part of the beauty (repeatable)")
      ->type_name("LAYER")
      ->expected(1)
      ->take_all();
  set.add(Changes::Result, "--map", o.roles,
          "Assign a role to a layer, or to a file: albedo=ViewLayer.MyAlbedo, albedo=shot_albedo.####.exr (repeatable)")
      ->type_name("ROLE=LAYER")
      ->expected(1)
      ->take_all();
  set.add_alias(
         "--prior", [&o](const std::string& layer) { o.roles.push_back("prior=" + layer); },
         "Denoised layer, or file, whose pixels are used where they are better; same as --map prior=LAYER. oidn: Open "
         "Image Denoise makes it")
      ->type_name("LAYER|FILE");
  add_denoiser_options(set, o.denoiser);
  set.add(Changes::Result, "--view-layer", o.read.view_layer,
          "View layer to denoise, in place of all that have a beauty")
      ->type_name("NAME");
  set.add(Changes::Result, "--view", o.read.view, "Stereo view to denoise, in place of all that have a beauty")
      ->type_name("NAME");
  set.add_choice(Changes::Result, "--variance-kind", o.read.variance_kind, variance_kinds,
                 "What variance layers hold: auto, mean (variance of the pixel), sample (variance of one sample), "
                 "moment (mean of the squares)");
  set.add_choice(Changes::Result, "--wrap", o.read.wrap, wraps,
                 "Columns of a panorama go on around it: x; auto: if the file says so (envmap latlong); none");
  set.add(Changes::Result, "--samples", o.read.samples, "Samples per pixel, if the file does not contain them")
      ->check(above_zero());
}

void add_sequence_options(OptionSet& set, DenoiseOptions& o) {
  set.begin_group("Sequences");
  set.add(Changes::Run, "--frames", o.frames, "Frames of a sequence, as 1-10,20-40x2; default: all that exist")
      ->check([](const std::string& text) { return std::string(text.empty() ? "is empty" : ""); }, "", "")
      ->type_name("RANGES");
  set.add(Changes::Result, "--frame-radius", o.frame_radius,
          fmt::format(
              "Frames before and after that help each frame of a sequence, along its motion vectors if it has any; "
              "default: {}",
              default_frame_radius))
      ->check(from_to(0, 8))
      ->type_name("R");
  set.add_flag(Changes::Run, "--skip-existing", o.run.skip_existing,
               "Skip frames whose result was made from the same input by the same settings and version; other results "
               "are replaced");
  set.add(Changes::Run, "--wait", o.run.wait,
          "Seconds to wait for an input that is missing or incomplete, counted from its last change")
      ->check(zero_or_more())
      ->type_name("SECONDS");
  set.add_flag(Changes::Run, "--strict", o.run.strict, "Stop at the first frame that is missing or damaged");
  set.add_flag(Changes::Run, "--dry-run", o.run.dry_run, "List what would be done, and check that the inputs exist");
}

void add_method_options(OptionSet& set, DenoiseOptions& o) {
  set.begin_group("Reconstruction");
  CLI::Option* quality =
      set.add_choice(Changes::Result, "--quality", o.quality, quality_names(), "From the fastest to the most accurate")
          ->default_str("standard");
  CLI::Option* stages = set.add(Changes::Result, "--stages", o.stages,
                                "Rounds of error estimation, 1 to 4, in place of the number that the quality sets");
  CLI::Option* order = set.add(Changes::Result, "--order", o.order,
                               "Highest polynomial order, 0 to 4, in place of the order that the quality sets");
  set.add(Changes::Result, "--time-budget", o.time_budget,
          "Seconds for one frame, reading and writing included: selects the most accurate settings that are predicted "
          "to fit")
      ->check(above_zero())
      ->type_name("SECONDS")
      ->excludes(quality)
      ->excludes(stages)
      ->excludes(order);
  set.add_choice(Changes::Run, "--on-miss", o.run.miss_fails, what_a_miss_does,
                 "Where --time-budget or --target cannot be reached, the best that can be done is written; keep ends "
                 "with code 0, fail with 8");
  add_steps_option(set, o.steps);
  set.add_flag(Changes::Result, "--alpha", o.alpha, "Denoise the alpha channel too; default: keep it");
}

void add_content_options(OptionSet& set, DenoiseOptions& o) {
  set.begin_group("Contents of the output");
  set.add(
         Changes::Result, "--outputs", o.contents,
         "What the output holds: beauty (the denoised layers alone), layers (those of the input too, but no variances, "
         "halves and sample counts), or input (all that the input holds); in addition noisy (the layers that were "
         "replaced, as '<layer> Noisy'), error and order ('<layer> Error', '<layer> Order')")
      ->type_name("LIST")
      ->capture_default_str();
  add_encoding_options(set, o.encoding, "that of the input, zip where it is lossy");
}

void add_run_options(OptionSet& set, DenoiseOptions& o) {
  set.begin_group("Run");
  set.add(Changes::Run, "-t,--threads", o.run.threads, "Threads to use; 0: one for each processor")
      ->check(from_to(0, 4096))
      ->capture_default_str();
  set.add(Changes::Run, "--max-memory", o.max_memory, max_memory_help)
      ->transform(CLI::AsSizeValue(false).description(""))
      ->type_name("SIZE")
      ->default_str(default_memory_text);
  set.add_choice(Changes::Run, "--progress", o.run.progress, progress_styles,
                 "Progress on standard error: bar (on a terminal; into a log a line a minute), none, json (one "
                 "object per line) or openjd (Open Job Description)");
  set.add_verbosity(o.run.verbosity);
}

}  // namespace

const Choices<Quality>& quality_names() {
  static const Choices<Quality> names = [] {
    Choices<Quality> out;
    for (const NamedQuality& named : qualities) out.emplace_back(named.name, named.quality);
    return out;
  }();
  return names;
}

void add_denoise_options(OptionSet& set, DenoiseOptions& options) {
  CLI::Option* sample_map = add_files(set, options);
  add_input_options(set, options);
  add_sequence_options(set, options);
  add_method_options(set, options);
  add_content_options(set, options);
  for (CLI::Option* option : add_sample_map_options(set, options.sample_map)) option->needs(sample_map);
  add_run_options(set, options);
  add_read_limits(set, options.read.limits);
}

}  // namespace polyrecon
