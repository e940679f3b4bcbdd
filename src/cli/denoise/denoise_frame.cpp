#include "cli/denoise/denoise_frame.h"

#include <fmt/format.h>

#include <chrono>
#include <cstdio>
#include <utility>

#include "cli/common/roles_output.h"
#include "cli/denoise/report.h"
#include "cli/denoise/write_outputs.h"
#include "io/atomic_file.h"
#include "polyrecon/reconstruct.h"

namespace polyrecon {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

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

std::vector<TimedNeighbour> neighbours_of(const LoadedFrame& loaded) {
  std::vector<TimedNeighbour> neighbours;
  for (const LoadedNeighbour& neighbour : loaded.neighbours)
    neighbours.push_back({neighbour.offset, neighbour.frame.get()});
  return neighbours;
}

}  // namespace

LoadedFrame load_frame(const std::string& path, const ReadOptions& options) {
  const auto start = Clock::now();
  LoadedFrame loaded{read_frame(path, options), 0, {}};
  loaded.read_seconds = seconds_since(start);
  return loaded;
}

void denoise_frame(const Job& job, const FrameFiles& files, LoadedFrame loaded, std::size_t max_memory,
                   Progress& progress) {
  const auto start = Clock::now();
  ReadResult& in = loaded.in;
  print(job.run.quiet, input_text(in));
  RunReport report;
  if (job.limits) report.chosen = choose_settings_for(job, in.frame, loaded.read_seconds, progress);
  Params params = report.chosen ? report.chosen->params : job.params;
  params.max_memory = max_memory;
  const Result result = reconstruct(in.frame, neighbours_of(loaded), params, progress);

  const auto written = Clock::now();
  report.notes = in.notes;
  for (const std::string& note : write_outputs(job, files, in, result, progress)) report.notes.push_back(note);
  report.read_seconds = loaded.read_seconds;
  report.write_seconds = seconds_since(written);
  report.version = POLYRECON_VERSION;
  report.input = files.input;
  report.output = files.outputs.picture;
  report.settings = settings_of(job, files);
  report.seconds = loaded.read_seconds + seconds_since(start);
  report.peak_memory = peak_memory();
  report.reconstruction = result.report;
  if (!files.outputs.report.empty()) write_bytes(files.outputs.report, report_json(report, in.source).dump(2) + "\n");
  print(job.run.quiet, report_text(report));
}

}  // namespace polyrecon
