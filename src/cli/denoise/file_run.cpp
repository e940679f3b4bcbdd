#include "cli/denoise/file_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <utility>

#include "cli/common/printed_text.h"
#include "cli/denoise/write_outputs.h"
#include "core/mean.h"
#include "core/stopwatch.h"
#include "denoisers/oidn_library.h"
#include "io/files/atomic_file.h"
#include "io/layers/pass_advice.h"
#include "pipeline/part_of_beauty.h"
#include "pipeline/result_images.h"

namespace polyrecon {
namespace {

constexpr double least_shared_noise = 0.1;          // share of the noisy pixels; below it chance may be the cause
constexpr double most_silent_energy_change = 0.01;  // the least step in brightness that is visible (Weber)

/// Notes of other frames differ in their numbers at most. The report has all of them.
void remove_notes_said_before(std::vector<std::string>& notes, RunProgress& progress) {
  const auto said_before = [&](std::string note) {
    note.erase(std::remove_if(note.begin(), note.end(), [](unsigned char c) { return std::isdigit(c) != 0; }),
               note.end());
    return !progress.is_new(note);
  };
  notes.erase(std::remove_if(notes.begin(), notes.end(), said_before), notes.end());
}

/// The note on neighbours that repeat the noise of a frame.
void note_shared_noise(const Report& report, std::vector<std::string>& notes) {
  if (report.neighbour_shared_noise < least_shared_noise) return;
  notes.push_back(
      fmt::format("in {:.0f} % of the noisy pixels the frames before and after repeat this frame's noise and bring "
                  "nothing: animate the seed, so that each frame has its own",
                  100 * report.neighbour_shared_noise));
}

/// The note on a picture that became brighter or darker.
void note_energy(const Report& report, std::vector<std::string>& notes) {
  constexpr std::array<const char*, 3> names{"red", "green", "blue"};
  std::string changes;
  for (std::size_t c = 0; c < names.size(); ++c)
    if (std::abs(report.energy_change[c]) > most_silent_energy_change)
      changes += fmt::format("{}{} {:+.1f} %", changes.empty() ? "" : ", ", names[c], 100 * report.energy_change[c]);
  if (!changes.empty())
    notes.push_back(
        fmt::format("the energy of the picture changed: {}; look whether the variance, the halves and the "
                    "features are those of this render",
                    changes));
}

std::vector<TimedNeighbour> neighbours_of(const LoadedFrame& loaded) {
  std::vector<TimedNeighbour> neighbours;
  for (const LoadedNeighbour& neighbour : loaded.neighbours)
    if (neighbour.frame) neighbours.push_back({neighbour.offset, neighbour.frame.get()});
  return neighbours;
}

std::size_t bytes_of(const DonePicture& done) {
  std::size_t samples = 0;
  const auto add = [&](const Image& image) { samples += image.pixels() * static_cast<std::size_t>(image.channels()); };
  for_images(done.result, add);
  add(done.in.frame.sample_count);
  return samples * sizeof(Real);
}

void keep_name(Pass& pass) {
  Pass named;
  named.name = std::move(pass.name);
  pass = std::move(named);
}

/// Takes the layers that are no part of the beauty out of the frame. Returns their names.
std::vector<std::string> take_own_windows(Frame& frame) {
  std::vector<std::string> names = layers_outside_beauty(frame);
  frame.aovs.erase(
      std::remove_if(frame.aovs.begin(), frame.aovs.end(),
                     [&](const Pass& aov) { return std::find(names.begin(), names.end(), aov.name) != names.end(); }),
      frame.aovs.end());
  return names;
}

}  // namespace

void FileRun::list_others(LoadedFrame& loaded) {
  if (count_ == 0) {
    count_ = 1;
    for (const LayerView& place : loaded.in.source.pictures)
      if (!(place == loaded.picture.place)) add({place, {}});
  }
  for (const std::string& layer : loaded.in.outside_beauty) add({loaded.picture.place, layer});
  for (const std::string& layer : take_own_windows(loaded.in.frame)) {
    add({loaded.picture.place, layer});
    loaded.in.notes.push_back(note_of_layer_outside_beauty(layer));
  }
}

void FileRun::add(PictureChoice picture) {
  if (!job_.run.may_replace()) {
    const OutputPaths maps = maps_of(files_.outputs, picture);
    std::vector<std::string> paths;
    for (const OutputOption& option : output_options())
      if (option.kind == OutputKind::Map) paths.push_back(maps.*option.path);
    require_new(paths);
  }
  left_.push_back(std::move(picture));
  ++count_;
}

std::optional<PictureChoice> FileRun::next() {
  if (left_.empty()) return std::nullopt;
  const PictureChoice picture = left_.front();
  left_.pop_front();
  return picture;
}

void FileRun::denoise(LoadedFrame loaded, std::size_t max_memory, RunProgress& progress) {
  const Stopwatch watch;
  progress.print(stdout, input_text(loaded.in, loaded.picture.name(), job_.run.verbosity));
  DonePicture done;
  done.identity = loaded.identity;
  done.neighbours_identity = loaded.neighbours_identity();
  done.in = std::move(loaded.in);
  RunReport& report = done.report;
  if (job_.limits)
    report.chosen = choose_settings_for(job_, limits_left(), done.in.frame, loaded.read_seconds, progress);
  Params params = report.chosen ? report.chosen->params : job_.params;
  params.max_memory = max_memory;
  for (const DonePicture& before : done_) params.max_memory -= std::min(params.max_memory, bytes_of(before));
  done.result = reconstruct(done.in.frame, neighbours_of(loaded), params, progress, job_.denoiser.get());
  report.noise_before = mean_of(done.result.error.relative_noise);
  // With a denoiser no other one is advised.
  report.advice =
      pass_advice(done.in.source, job_.denoiser ? 0 : mean_samples(done.in.frame.sample_count), oidn_is_installed());
  release_images(done);
  report.picture = loaded.picture;
  report.notes = done.in.notes;
  note_shared_noise(done.result.report, report.notes);
  note_energy(done.result.report, report.notes);
  report.read_seconds = loaded.read_seconds;
  report.seconds = loaded.read_seconds + watch.seconds();
  report.reconstruction = done.result.report;
  spent_ += report.seconds;
  done_.push_back(std::move(done));
}

FrameLimits FileRun::limits_left() const {
  FrameLimits limits = job_.limits->after(spent_);
  limits.seconds /= static_cast<double>(count_ - done_.size());
  return limits;
}

void FileRun::release_images(DonePicture& done) const {
  Frame& frame = done.in.frame;
  keep_name(frame.beauty);
  keep_name(frame.prior);
  for (Pass& aov : frame.aovs) keep_name(aov);
  frame.features.clear();
  frame.alpha = frame.motion = {};
  if (!job_.params.reconstruct_alpha) done.result.alpha = {};
  if (files_.outputs.order_map.empty() && !job_.contents.order) done.result.order = {};
  if (files_.outputs.error_map.empty() && files_.outputs.sample_map.empty()) {
    for (const ErrorMapImage& entry : error_map_images)
      if (!job_.contents.error || entry.image != &ErrorMap::relative_mse) done.result.error.*entry.image = {};
    frame.sample_count = {};
  }
}

std::vector<std::string> FileRun::missed_limits() const {
  std::vector<std::string> missed;
  if (!job_.limits) return missed;
  double seconds = 0;
  for (const DonePicture& done : done_) seconds += done.report.seconds;
  if (job_.limits->seconds > 0 && seconds > job_.limits->seconds)
    missed.push_back(fmt::format("took {:.3g} s, so --time-budget {:g} was missed", seconds, job_.limits->seconds));
  for (const DonePicture& done : done_) {
    const double error = done.result.report.estimated_relative_mse;
    if (job_.limits->relative_mse > 0 && error > job_.limits->relative_mse)
      missed.push_back(fmt::format("estimated relMSE {:.3g}, so --target {:g} was missed: render more samples", error,
                                   job_.limits->relative_mse));
  }
  return missed;
}

bool FileRun::write(RunProgress& progress) {
  const Stopwatch watch;
  RunReport& first = done_.front().report;
  for (const std::string& note : write_outputs(job_, files_, done_, progress)) first.notes.push_back(note);
  first.write_seconds = watch.seconds();
  first.seconds += first.write_seconds;
  first.missed = missed_limits();
  std::string text;
  std::vector<nlohmann::ordered_json> reports;
  for (DonePicture& done : done_) {
    RunReport& one = done.report;
    one.version = POLYRECON_VERSION;
    one.input = files_.input;
    one.output = files_.outputs.picture;
    one.settings = settings_of(job_, files_);
    one.peak_memory = peak_memory();
    if (done_.size() > 1) one.title = one.picture.name();
    reports.push_back(report_json(one, done.in.source));
    if (job_.run.verbosity == Verbosity::Short) remove_notes_said_before(one.notes, progress);
    std::vector<std::string> advice = advice_lines(one.advice);
    advice.erase(
        std::remove_if(advice.begin(), advice.end(), [&](const std::string& line) { return !progress.is_new(line); }),
        advice.end());
    text += report_text(one, advice, job_.run.verbosity);
  }
  if (!files_.outputs.report.empty()) {
    reports.front()["others"] = std::vector<nlohmann::ordered_json>(reports.begin() + 1, reports.end());
    write_bytes(files_.outputs.report, json_text(reports.front()));
  }
  progress.print(stdout, text);
  for (const std::string& missed : first.missed)
    progress.print(stderr, text_line("polyrecon: {}: {}", files_.outputs.picture, missed));
  return !first.missed.empty();
}

}  // namespace polyrecon
