#include "cli/denoise/fetch_frame.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <system_error>
#include <thread>
#include <utility>

#include "cli/common/checks.h"
#include "cli/denoise/finished.h"
#include "core/stopwatch.h"
#include "polyrecon/error.h"
#include "polyrecon/reconstruct.h"

namespace polyrecon {
namespace {

namespace fs = std::filesystem;

constexpr std::chrono::milliseconds first_pause{50}, longest_pause{2000};

/// Size and time of a file, which change while it is being written; constant where there is no file.
std::pair<std::uintmax_t, fs::file_time_type> size_and_time(const std::string& path) {
  std::error_code ignored;
  return {fs::file_size(path, ignored), fs::last_write_time(path, ignored)};
}

/// Whether the file may still become readable. A layer that it lacks will not appear.
bool may_become_readable(const Error& error, const std::string& path) {
  std::error_code ignored;
  return error.code() == ExitCode::BadInput || (error.code() == ExitCode::Missing && !fs::exists(path, ignored));
}

std::string key_of(const std::string& path, const PictureChoice& picture) { return path + '\n' + picture.name(); }

/// Shows nothing; asks the fetcher's owner whether to stop.
class Cancellable final : public Progress {
 public:
  explicit Cancellable(const std::function<bool()>& cancelled) : cancelled_(cancelled) {}
  bool cancelled() const override { return cancelled_(); }

 private:
  const std::function<bool()>& cancelled_;
};

}  // namespace

template <typename Attempt>
auto FrameFetcher::wait_for(const std::string& path, double seconds, const Attempt& attempt) {
  auto last = size_and_time(path);
  Stopwatch unchanged;
  auto pause = first_pause;
  for (;;) try {
      return attempt();
    } catch (const Error& error) {
      const auto now = size_and_time(path);
      if (now != last) unchanged = {};
      last = now;
      if (unchanged.seconds() >= seconds || !may_become_readable(error, path)) throw;
      if (cancelled_()) throw Error(ExitCode::Interrupted, "interrupted");
      std::this_thread::sleep_for(pause);
      pause = std::min(2 * pause, longest_pause);
    }
}

std::optional<LoadedFrame> FrameFetcher::fetch(const FrameFiles& files) {
  return wait_for(files.input, job_.run.wait, [&]() -> std::optional<LoadedFrame> {
    if (job_.run.skip_existing && is_finished(job_, files)) return std::nullopt;
    if (job_.sample_map && !job_.sample_map->cost.empty()) require_readable(sample_map_for(job_, files).cost);
    return load_with_neighbours(files, read_options_for(job_, files.number_in_names()));
  });
}

LoadedFrame FrameFetcher::fetch(const FrameFiles& files, const PictureChoice& picture) {
  return load_with_neighbours(files, with_picture(read_options_for(job_, files.number_in_names()), picture));
}

LoadedFrame FrameFetcher::load_with_neighbours(const FrameFiles& files, const ReadOptions& options) {
  LoadedFrame loaded = load_frame(files.input, options);
  for (std::string& note : fixed_file_notes(job_, loaded.in.source)) loaded.in.notes.push_back(std::move(note));
  if (!files.neighbours.empty()) add_neighbours(files, loaded);
  return loaded;
}

void FrameFetcher::add_neighbours(const FrameFiles& files, LoadedFrame& loaded) {
  const Stopwatch watch;
  std::map<std::string, Prepared> kept;
  for (const NeighbourFile& file : files.neighbours)
    if (Prepared prepared = neighbour(file, loaded)) {
      loaded.neighbours.push_back({file.offset, prepared});
      kept[key_of(file.path, loaded.picture)] = std::move(prepared);
    }
  // The frame itself is a neighbour of the next one.
  Cancellable progress(cancelled_);
  const std::string key = key_of(files.input, loaded.picture);
  const auto known = prepared_.find(key);
  kept[key] =
      known != prepared_.end() ? known->second : prepare_neighbour(loaded.in.frame, files.place, job_.params, progress);
  prepared_ = std::move(kept);
  loaded.read_seconds += watch.seconds();
}

FrameFetcher::Prepared FrameFetcher::neighbour(const NeighbourFile& file, LoadedFrame& loaded) {
  const auto known = prepared_.find(key_of(file.path, loaded.picture));
  if (known != prepared_.end()) return known->second;
  const double patience = file.is_denoised_too ? job_.run.wait : 0;
  Cancellable progress(cancelled_);
  try {
    return wait_for(file.path, patience, [&] {
      LoadedFrame frame = load_frame(file.path, with_picture(read_options_for(job_, file.frame), loaded.picture));
      return prepare_neighbour(std::move(frame.in.frame), file.number, job_.params, progress);
    });
  } catch (const Error& error) {
    if (error.code() == ExitCode::Interrupted) throw;
    std::error_code ignored;
    if (fs::exists(file.path, ignored))
      loaded.in.notes.push_back(fmt::format("denoised without this neighbour: {}", error.what()));
    return nullptr;
  }
}

}  // namespace polyrecon
