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
#include "cli/common/layers.h"
#include "cli/denoise/finished.h"
#include "core/stopwatch.h"
#include "io/files/file_identity.h"
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

/// The identity of a file that could not be read; of no file where it has changed since.
std::string unread_identity(const std::string& path, const FileStamp& stamp) {
  const std::string identity = file_identity(path);
  return stamp_of(path) == stamp ? identity : "changed while it was read";
}

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
    return load_with_neighbours(files, read_options_for(job_, files.number_in_names()));
  });
}

LoadedFrame FrameFetcher::fetch(const FrameFiles& files, const PictureChoice& picture) {
  return load_with_neighbours(files, with_picture(read_options_for(job_, files.number_in_names()), picture));
}

LoadedFrame FrameFetcher::load_with_neighbours(const FrameFiles& files, const ReadOptions& options) {
  LoadedFrame loaded = load_frame(files.input, options);
  if (job_.sample_map && !job_.sample_map->cost.empty()) {
    const std::string cost = sample_map_for(job_, files).cost;
    require_readable(cost);
    require_cost(cost, loaded.in.frame.width(), loaded.in.frame.height());
  }
  for (std::string& note : fixed_file_notes(job_, loaded.in.source)) loaded.in.notes.push_back(std::move(note));
  if (!files.neighbours.empty()) add_neighbours(files, loaded);
  return loaded;
}

void FrameFetcher::add_neighbours(const FrameFiles& files, LoadedFrame& loaded) {
  const Stopwatch watch;
  std::map<std::string, LoadedNeighbour> kept;
  for (const NeighbourFile& file : files.neighbours) {
    LoadedNeighbour found = neighbour(file, loaded);
    if (found.frame) kept[key_of(file.path, loaded.picture)] = found;
    found.offset = file.offset;
    if (!found.identity.empty()) loaded.neighbours.push_back(std::move(found));
  }
  // The frame itself is a neighbour of the next one.
  Cancellable progress(cancelled_);
  const std::string key = key_of(files.input, loaded.picture);
  const auto known = prepared_.find(key);
  kept[key] =
      known != prepared_.end()
          ? known->second
          : LoadedNeighbour{0, prepare_neighbour(loaded.in.frame, files.place, job_.params, progress), loaded.identity};
  prepared_ = std::move(kept);
  loaded.read_seconds += watch.seconds();
}

LoadedNeighbour FrameFetcher::neighbour(const NeighbourFile& file, LoadedFrame& loaded) {
  const auto known = prepared_.find(key_of(file.path, loaded.picture));
  if (known != prepared_.end()) return known->second;
  const double patience = file.is_denoised_too ? job_.run.wait : 0;
  Cancellable progress(cancelled_);
  FileStamp stamp;
  try {
    return wait_for(file.path, patience, [&] {
      stamp = stamp_of(file.path);
      LoadedFrame frame = load_frame(file.path, with_picture(read_options_for(job_, file.frame), loaded.picture));
      const auto prepared = prepare_neighbour(std::move(frame.in.frame), file.number, job_.params, progress);
      return LoadedNeighbour{0, prepared, std::move(frame.identity)};
    });
  } catch (const Error& error) {
    if (error.code() == ExitCode::Interrupted) throw;
    std::error_code ignored;
    if (!fs::exists(file.path, ignored)) return {};
    loaded.in.notes.push_back(fmt::format("denoised without this neighbour: {}", error.what()));
    if (!fs::is_regular_file(file.path, ignored)) return {};
    return {0, nullptr, unread_identity(file.path, stamp)};
  }
}

}  // namespace polyrecon
