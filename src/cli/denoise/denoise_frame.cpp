#include "cli/denoise/denoise_frame.h"

#include <fmt/format.h>

#include <chrono>
#include <cstdio>
#include <vector>

#include "cli/common/map_files.h"
#include "cli/common/report_output.h"
#include "cli/denoise/finished.h"
#include "io/atomic_file.h"
#include "io/channel_names.h"
#include "polyrecon/error.h"
#include "polyrecon/reconstruct.h"
#include "polyrecon/write_result.h"

namespace polyrecon {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

/// The layer that holds the picture: the denoised one where the renderer's own denoiser left both (there people and
/// compositors look for the result), else the noisy one that was reconstructed.
std::string picture_layer(const ReadResult& in) {
  for (const Role role : {Role::Prior, Role::Beauty})
    for (const RoleChoice& choice : in.source.chosen) {
      if (choice.role != role || choice.companion != Companion::Mean) continue;
      for (const Layer& layer : in.source.layers)
        if (layer.name == choice.layer && layer.file == 0 &&
            (role == Role::Beauty || (layer.rank != rank_by_hand && layer.rank != rank_beside)))
          return layer.name;
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
std::vector<std::string> write_all(const FrameFiles& files, const DenoiseOptions& o, const ReadResult& in,
                                   const Result& result, Progress& progress) {
  const std::string picture = picture_layer(in);
  WriteOptions options;
  options.keep_noisy = o.keep_noisy;
  options.provenance = {settings_text(o), input_identity(files, in.source), result.report.estimated_relative_mse};
  std::vector<std::string> notes =
      write_result(in.source, replacements(in, result, picture, o.alpha), files.output, options);
  const MapWindows windows = windows_of(in, picture);
  const Image samples = sample_counts(o, in);
  if (!files.error_map.empty()) write_error_map(files.error_map, result.error, samples, windows);
  if (!files.order_map.empty()) write_order_map(files.order_map, result.order, windows);
  if (!files.sample_map.empty())
    notes.push_back("sample map: " +
                    make_and_write_sample_map(files.sample_map, result.error, samples, windows, o.sampling, progress));
  return notes;
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

}  // namespace

DenoiseOptions options_for(const FrameFiles& files, const DenoiseOptions& options) {
  DenoiseOptions out = options;
  if (files.frame) out.sampling.frame = *files.frame;
  return out;
}

LoadedFrame load_frame(const std::string& path, const DenoiseOptions& options) {
  const auto start = Clock::now();
  LoadedFrame loaded{read_frame(path, options.read), 0, {}};
  loaded.read_seconds = seconds_since(start);
  return loaded;
}

void denoise_frame(const FrameFiles& files, LoadedFrame loaded, const DenoiseOptions& o, Progress& progress) {
  const auto start = Clock::now();
  ReadResult& in = loaded.in;
  print(o.quiet, input_text(in));
  std::vector<TimedNeighbour> neighbours;
  for (const LoadedNeighbour& neighbour : loaded.neighbours)
    neighbours.push_back({neighbour.offset, neighbour.frame.get()});
  RunReport report;
  if (wants_plan(o)) report.plan = read_frame_header(o, in.frame, loaded.read_seconds, progress);
  const Params params = report.plan ? report.plan->params : params_of(o);
  const Result result = reconstruct(in.frame, neighbours, params, progress);

  report.notes = in.notes;
  const auto written = Clock::now();
  const std::vector<std::string> notes = write_all(files, o, in, result, progress);
  report.notes.insert(report.notes.end(), notes.begin(), notes.end());
  report.read_seconds = loaded.read_seconds;
  report.write_seconds = seconds_since(written);
  report.version = POLYRECON_VERSION;
  report.input = files.input;
  report.output = files.output;
  report.settings = settings_text(o);
  report.seconds = loaded.read_seconds + seconds_since(start);
  report.peak_memory = peak_memory();
  report.reconstruction = result.report;
  if (!files.report.empty()) write_bytes(files.report, report_json(report, in.source).dump(2) + "\n");
  print(o.quiet, report_text(report));
}

}  // namespace polyrecon
