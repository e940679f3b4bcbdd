#include "cli/fetch_frame.h"

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <system_error>
#include <thread>
#include <utility>

#include "cli/finished.h"
#include "core/error.h"

namespace polyrecon {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds first_pause{50}, longest_pause{2000};

/// What changes as long as somebody writes to a file; all the same where there is none.
std::pair<std::uintmax_t, fs::file_time_type> trace_of(const std::string& path) {
  std::error_code ignored;
  return {fs::file_size(path, ignored), fs::last_write_time(path, ignored)};
}

/// Whether the file itself may still become readable; a layer that it lacks will not come.
bool may_come(const Error& error, const std::string& path) {
  std::error_code ignored;
  return error.code() == ExitCode::BadInput || (error.code() == ExitCode::Missing && !fs::exists(path, ignored));
}

std::optional<LoadedFrame> fetch_now(const FrameFiles& files, const DenoiseOptions& options) {
  if (options.skip_existing && is_finished(files, options)) return std::nullopt;
  return load_frame(files.input, options);
}

}  // namespace

std::optional<LoadedFrame> fetch_frame(const FrameFiles& files, const DenoiseOptions& options,
                                       const std::function<bool()>& cancelled) {
  auto trace = trace_of(files.input);
  auto changed = Clock::now();
  auto pause = first_pause;
  for (;;) try {
      return fetch_now(files, options);
    } catch (const Error& error) {
      const auto now = trace_of(files.input);
      if (now != trace) changed = Clock::now();
      trace = now;
      const std::chrono::duration<double> unchanged = Clock::now() - changed;
      if (unchanged.count() >= options.wait || !may_come(error, files.input)) throw;
      if (cancelled()) throw Error(ExitCode::Interrupted, "interrupted");
      std::this_thread::sleep_for(pause);
      pause = std::min(2 * pause, longest_pause);
    }
}

}  // namespace polyrecon
