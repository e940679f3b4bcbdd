#include "sweep/sweep.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "cli/commands.h"
#include "cli/common/checks.h"
#include "cli/common/display_options.h"
#include "cli/common/frame_names.h"
#include "cli/common/layers.h"
#include "cli/common/memory_limit.h"
#include "cli/common/numbers.h"
#include "cli/common/option_set.h"
#include "cli/common/printed_text.h"
#include "cli/common/progress_output.h"
#include "cli/common/verbosity.h"
#include "core/mean.h"
#include "core/parallel.h"
#include "io/files/atomic_file.h"
#include "polyrecon/error.h"
#include "polyrecon/read_frame.h"
#include "sweep/page.h"

namespace polyrecon {
namespace {

/// All groups but "ablation": users do not choose between its settings.
std::vector<std::string> trade_groups() {
  std::vector<std::string> groups = setting_groups();
  groups.erase(std::remove(groups.begin(), groups.end(), "ablation"), groups.end());
  return groups;
}

struct SweepOptions {
  std::vector<std::string> inputs, also;
  std::string reference, output, csv;
  std::vector<std::string> groups = trade_groups();
  int threads = 0;
  bool overwrite = false;
  Verbosity verbosity = Verbosity::Short;
  std::size_t max_size = default_page_size;
  std::size_t max_memory = default_memory();
};

/// The value of --also, "NAME=FILE:SECONDS". FILE may contain colons; NAME contains no equals sign.
struct PeerFile {
  std::string name, file;
  double seconds = 0;
};

PeerFile parse_peer(const std::string& text) {
  const std::size_t equals = text.find('='), colon = text.rfind(':');
  const auto wrong = [&](const char* why) {
    return Error(ExitCode::Usage, fmt::format("--also {}: {}; it must be NAME=FILE:SECONDS", text, why));
  };
  if (equals == std::string::npos || equals == 0) throw wrong("no name");
  if (colon == std::string::npos || colon < equals + 2) throw wrong("no seconds");
  PeerFile peer{text.substr(0, equals), text.substr(equals + 1, colon - equals - 1), 0};
  try {
    std::size_t used = 0;
    peer.seconds = std::stod(text.substr(colon + 1), &used);
    if (used != text.size() - colon - 1) throw wrong("the seconds are not a number");
  } catch (const std::logic_error&) {  // of stod
    throw wrong("the seconds are not a number");
  }
  if (!(peer.seconds > 0) || !std::isfinite(peer.seconds)) throw wrong("the seconds are not above 0");
  return peer;
}

/// The main colour layer of a file: width x height must be the reference's.
Image read_color(const LayeredFile& file, const Image& reference) {
  const Layer& layer = require_color_layer(file);
  Image image = read_radiance(file, layer);
  if (!reference.empty() && !image.same_shape(reference))
    throw Error(ExitCode::BadInput,
                fmt::format("{}: layer '{}' has {} x {} pixels, the reference has {} x {}", file.info.path, layer.name,
                            image.width(), image.height(), reference.width(), reference.height()));
  return image;
}

Reference read_reference(const std::string& path) {
  const LayeredFile file = open_layers(path);
  Image mean = read_color(file, {});
  KnownVariance known = read_variance(file, require_color_layer(file), mean);
  if (!known.note.empty()) std::fputs(text_line("polyrecon: {}", known.note).c_str(), stderr);
  return {std::move(mean), std::move(known.variance)};
}

SweepInput read_input(const std::string& path, const Image& reference) {
  ReadResult read = read_frame(path);
  if (read.frame.width() != reference.width() || read.frame.height() != reference.height())
    throw Error(ExitCode::BadInput,
                fmt::format("{}: has {} x {} pixels, the reference has {} x {}", path, read.frame.width(),
                            read.frame.height(), reference.width(), reference.height()));
  const double samples = mean_samples(read.frame.sample_count);
  return {file_name(path), samples, std::move(read.frame)};
}

std::vector<PeerFile> peers_of(const SweepOptions& o) {
  std::vector<PeerFile> peers;
  for (const std::string& text : o.also) peers.push_back(parse_peer(text));
  return peers;
}

std::vector<NamedPath> outputs_of(const SweepOptions& o) {
  return {{"-o", o.output, FileKind::Page}, {"--csv", o.csv, FileKind::Csv}};
}

void check(const SweepOptions& o) {
  peers_of(o);
  require_endings(outputs_of(o));
}

void check_files(const SweepOptions& o, const std::vector<PeerFile>& peers) {
  std::vector<std::string> files = o.inputs;
  files.push_back(o.reference);
  for (const PeerFile& peer : peers) files.push_back(peer.file);
  for (const std::string& file : files) require_readable(file);
  require_outputs(files, outputs_of(o), o.overwrite);
}

void run(const SweepOptions& o) {
  limit_memory(o.max_memory);
  const std::vector<PeerFile> peer_files = peers_of(o);
  check_files(o, peer_files);
  set_thread_limit(o.threads);
  const Reference reference = read_reference(o.reference);
  std::vector<SweepInput> inputs;
  for (const std::string& path : o.inputs) inputs.push_back(read_input(path, reference.mean));
  std::vector<Peer> peers;
  for (const PeerFile& peer : peer_files)
    peers.push_back({peer.name, peer.seconds, read_color(open_layers(peer.file), reference.mean), {}});
  const auto progress = make_progress(o.verbosity == Verbosity::Quiet ? ProgressStyle::None : ProgressStyle::Bar);
  Sweep sweep = run_sweep(inputs, o.groups, reference, std::move(peers), *progress);
  sweep.reference_name = file_name(o.reference);
  if (o.threads > 0) sweep.threads = o.threads;
  write_bytes(o.output, page_of(sweep, POLYRECON_VERSION, o.max_size));
  if (!o.csv.empty()) write_bytes(o.csv, csv_of(sweep));
  if (o.verbosity == Verbosity::Quiet) return;
  for (const Trial& trial : sweep.inputs.front().trials)
    std::fputs(
        text_line("{:<32} {:8.2f} s  relMSE {:.5f}", trial.name, trial.seconds, trial.score.relative_mse).c_str(),
        stdout);
}

}  // namespace

void setup_sweep(CLI::App& app, Command& chosen) {
  const auto o = std::make_shared<SweepOptions>();
  CLI::App* sub = app.add_subcommand("sweep", "Measures time and error of many settings on a render with a reference");
  sub->add_option(
         "-i,--input", o->inputs,
         "Noisy render; repeat it for the same frame with other sample counts, which are tried by the qualities only")
      ->required()
      ->expected(1)
      ->take_all()
      ->type_name("FILE");
  sub->add_option("--reference", o->reference, "Converged render of the frame")->required()->type_name("FILE");
  sub->add_option("-o,--output", o->output, "Report to write, an HTML page")->required()->type_name("FILE");
  sub->add_option("--csv", o->csv, "Write all figures as CSV too")->type_name("FILE");
  sub->add_option("--also", o->also, "Result of another program to compare with, as NAME=FILE:SECONDS (repeatable)")
      ->expected(1)
      ->take_all()
      ->type_name("NAME=FILE:SECONDS");
  sub->add_option("--vary", o->groups,
                  "Parameters to vary; default: all but ablation. There are " +
                      fmt::format("{}", fmt::join(setting_groups(), ", ")))
      ->delimiter(',')
      ->check(one_of(setting_groups()))
      ->type_name("GROUP,...");
  sub->add_option("-t,--threads", o->threads, "Threads to use; 0: one for each processor")
      ->check(from_to(0, 4096))
      ->capture_default_str();
  add_page_size(*sub, o->max_size);
  add_memory_limit(*sub, o->max_memory);
  add_overwrite(*sub, o->overwrite);
  add_quiet(*sub, o->verbosity);
  sub->footer(
      "Short runs are repeated, up to three times and two seconds; the median counts. The group \"ablation\" disables "
      "one "
      "component\n"
      "of the method at a time.\n"
      "Examples:\n"
      "  polyrecon sweep -i render.exr --reference ref.exr -o report.html --csv figures.csv\n"
      "  polyrecon sweep -i 16.exr -i 64.exr -i 256.exr --reference ref.exr -o report.html --vary quality\n"
      "  polyrecon sweep -i render.exr --reference ref.exr -o report.html --also OIDN=oidn.exr:0.9");
  set_callback(*sub, o, run, check, chosen);
}

}  // namespace polyrecon
