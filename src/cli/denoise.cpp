#include <fmt/format.h>

#include <chrono>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "cli/checks.h"
#include "cli/choice.h"
#include "cli/commands.h"
#include "cli/map_files.h"
#include "cli/progress_output.h"
#include "cli/report_output.h"
#include "cli/sample_map_options.h"
#include "core/error.h"
#include "core/parallel.h"
#include "io/atomic_file.h"
#include "io/read_frame.h"
#include "io/write_result.h"
#include "pipeline/reconstruct.h"

namespace polyrecon {
namespace {

struct DenoiseOptions {
  std::string input, output, error_map, order_map, sample_map, report;
  std::vector<std::string> roles;  ///< "role=LAYER"
  ReadOptions read;
  Quality quality = Quality::Standard;
  std::optional<int> stages, order;  ///< In place of what the quality says.
  std::optional<std::size_t> max_memory;
  bool alpha = false;
  SampleMapOptions sampling;
  bool sampling_given = false;
  bool keep_noisy = false, quiet = false;
  int threads = 0;
  ProgressStyle progress = ProgressStyle::Auto;
};

const std::map<std::string, Quality> qualities{
    {"draft", Quality::Draft}, {"standard", Quality::Standard}, {"best", Quality::Best}};
const std::map<std::string, VarianceKind> variance_kinds{{"auto", VarianceKind::Auto},
                                                         {"mean", VarianceKind::Mean},
                                                         {"sample", VarianceKind::Sample},
                                                         {"moment", VarianceKind::SecondMoment}};
const std::map<std::string, ProgressStyle> progress_styles{
    {"none", ProgressStyle::None}, {"bar", ProgressStyle::Bar}, {"json", ProgressStyle::Json}};

template <typename Value>
std::string key_of(const std::map<std::string, Value>& names, Value value) {
  for (const auto& [name, v] : names)
    if (v == value) return name;
  return {};
}

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

Params params_of(const DenoiseOptions& o) {
  Params params = params_for(o.quality);
  if (o.stages) params.stages = *o.stages;
  if (o.order) params.max_order = *o.order;
  if (o.max_memory) params.max_memory = *o.max_memory;
  params.reconstruct_alpha = o.alpha;
  return params;
}

/// What the result depends on, in the words of the command line; goes into the file and the report.
std::string settings_text(const DenoiseOptions& o) {
  const Params params = params_of(o);
  std::string text = fmt::format("--quality {} --stages {} --order {} --variance-kind {}", key_of(qualities, o.quality),
                                 params.stages, params.max_order, key_of(variance_kinds, o.read.variance_kind));
  if (params.reconstruct_alpha) text += " --alpha";
  if (!o.read.view_layer.empty()) text += " --view-layer '" + o.read.view_layer + "'";
  for (const std::string& aov : o.read.aovs) text += " --aov '" + aov + "'";
  for (const std::string& role : o.roles) text += " --map '" + role + "'";
  return text;
}

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

/// The layer that holds the picture: the denoised one where the file has both (there people and compositors look for
/// the result), else the noisy one that was reconstructed.
std::string picture_layer(const ReadResult& in) {
  for (const Role role : {Role::Prior, Role::Beauty})
    for (const RoleChoice& choice : in.source.chosen) {
      if (choice.role != role || choice.companion != Companion::Mean) continue;
      for (const Layer& layer : in.source.layers)
        if (layer.name == choice.layer && layer.file == 0) return layer.name;
    }
  return in.frame.beauty.name;
}

MapWindows windows_of(const ReadResult& in, const std::string& layer_name) {
  for (const Layer& layer : in.source.layers)
    if (layer.name == layer_name && layer.file == 0)
      return {in.frame.data_window, in.source.files[0].parts[static_cast<std::size_t>(layer.part)].display_window};
  return {in.frame.data_window, in.frame.data_window};
}

std::vector<Replacement> replacements(const ReadResult& in, const Result& result, const std::string& picture,
                                      bool with_alpha) {
  std::vector<Replacement> list{{picture, result.beauty, false}};
  for (std::size_t i = 0; i < result.aovs.size(); ++i) list.push_back({in.frame.aovs[i].name, result.aovs[i], false});
  if (with_alpha && !result.alpha.empty() && !in.source.alpha_layer.empty())
    list.push_back({in.source.alpha_layer, result.alpha, true});
  return list;
}

std::string identity(const FrameSource& source) {
  return fmt::format("{}, {} bytes", std::filesystem::path(source.path).filename().string(), source.files[0].bytes);
}

/// Samples per pixel: of the file's layer, else the number that the command line or the metadata tell; empty where
/// unknown.
Image sample_counts(const DenoiseOptions& o, const ReadResult& in) {
  if (!in.frame.sample_count.empty()) return in.frame.sample_count;
  const double everywhere = o.read.samples > 0
                                ? o.read.samples
                                : samples_in_metadata(in.source.files.front(), in.source.view_layer).value_or(0);
  return everywhere > 0 ? Image(in.frame.width(), in.frame.height(), 1, static_cast<Real>(everywhere)) : Image();
}

/// Writes the picture and the maps; returns notes.
std::vector<std::string> write_all(const DenoiseOptions& o, const ReadResult& in, const Result& result,
                                   Progress& progress) {
  const std::string picture = picture_layer(in);
  WriteOptions options;
  options.keep_noisy = o.keep_noisy;
  options.provenance = {settings_text(o), identity(in.source), result.report.estimated_relative_mse};
  std::vector<std::string> notes =
      write_result(in.source, replacements(in, result, picture, o.alpha), o.output, options);
  const MapWindows windows = windows_of(in, picture);
  const Image samples = sample_counts(o, in);
  if (!o.error_map.empty()) write_error_map(o.error_map, result.error, samples, windows);
  if (!o.order_map.empty()) write_order_map(o.order_map, result.order, windows);
  if (!o.sample_map.empty())
    notes.push_back("sample map: " +
                    make_and_write_sample_map(o.sample_map, result.error, samples, windows, o.sampling, progress));
  return notes;
}

void write_text(const std::string& target, const std::string& text) {
  const auto write = [&](const std::string& path) { std::ofstream(path, std::ios::binary) << text; };
  const auto verify = [&](const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    if (std::string(std::istreambuf_iterator<char>(file), {}) != text)
      throw Error(ExitCode::CannotWrite, target + ": cannot be read back, is the disk full?");
  };
  write_atomically(target, write, verify);
}

void print(bool quiet, const std::string& text) {
  if (quiet) return;
  std::fputs(text.c_str(), stdout);
  std::fflush(stdout);
}

std::string input_text(const ReadResult& in) {
  std::string text = fmt::format("{}: {} x {}{}\n", in.source.path, in.frame.width(), in.frame.height(),
                                 in.source.view_layer.empty() ? "" : ", view layer " + in.source.view_layer);
  return text + roles_text(in.source);
}

void run(DenoiseOptions o) {
  const auto start = std::chrono::steady_clock::now();
  for (const std::string& role : o.roles) o.read.map.push_back(parse_mapping(role));
  check(o);
  set_thread_limit(o.threads);
  set_codec_threads(o.threads > 0 ? o.threads : processors());
  const Params params = params_of(o);
  o.read.limits.max_bytes = params.max_memory;
  const auto progress = make_progress(o.quiet ? ProgressStyle::None : o.progress);

  const ReadResult in = read_frame(o.input, o.read);
  RunReport report;
  report.read_seconds = seconds_since(start);
  print(o.quiet, input_text(in));

  const Result result = reconstruct(in.frame, params, *progress);
  const auto written = std::chrono::steady_clock::now();
  report.notes = in.notes;
  const std::vector<std::string> notes = write_all(o, in, result, *progress);
  report.notes.insert(report.notes.end(), notes.begin(), notes.end());
  report.write_seconds = seconds_since(written);

  report.version = POLYRECON_VERSION;
  report.input = o.input;
  report.output = o.output;
  report.settings = settings_text(o);
  report.seconds = seconds_since(start);
  report.peak_memory = peak_memory();
  report.reconstruction = result.report;
  report.calibration = result.error.calibration;
  if (!o.report.empty()) write_text(o.report, report_json(report, in.source).dump(2) + "\n");
  print(o.quiet, report_text(report));
}

void add_files(CLI::App& app, DenoiseOptions& o) {
  app.add_option("-i,--input", o.input, "Noisy render: EXR, or what OpenImageIO reads")->required()->type_name("FILE");
  app.add_option("-o,--output", o.output, "Clean EXR to write")->required()->type_name("FILE");
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
  add_choice(app, "--quality", o.quality, qualities, "draft, standard or best")->group(group);
  app.add_option("--stages", o.stages, "Rounds of error estimation, 1 to 4, in place of what the quality takes")
      ->group(group);
  app.add_option("--order", o.order, "Highest polynomial order, 0 to 4, in place of what the quality takes")
      ->group(group);
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
             "none, bar or json (one object per line), on standard error; a bar on a terminal")
      ->group(group);
  app.add_flag("-q,--quiet", o.quiet, "Print nothing but errors")->group(group);
}

}  // namespace

void setup_denoise(CLI::App& app, Command& chosen) {
  const auto o = std::make_shared<DenoiseOptions>();
  CLI::App* sub = app.add_subcommand("denoise", "Rebuilds a clean image from a noisy render and its feature passes");
  add_files(*sub, *o);
  add_input_options(*sub, *o);
  add_method_options(*sub, *o);
  add_sample_map_options(*sub, o->sampling);
  add_run_options(*sub, *o);
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
