#include "cli/denoise/sequence.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <atomic>
#include <cstdio>
#include <future>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include "cli/common/frame_names.h"
#include "cli/denoise/denoise_frame.h"
#include "cli/denoise/fetch_frame.h"
#include "cli/denoise/finished.h"
#include "pipeline/memory.h"
#include "polyrecon/error.h"

namespace polyrecon {
namespace {

/// Whether the next frame may still do better.
bool concerns_one_frame(ExitCode code) {
  return code == ExitCode::BadInput || code == ExitCode::Missing || code == ExitCode::CheckFailed ||
         code == ExitCode::OutOfMemory;
}

/// Frames that came to nothing, and those that did with less than the others.
class Outcome {
 public:
  explicit Outcome(const DenoiseOptions& options) : options_(options) {}

  /// To be called inside a catch block.
  void failed(const FrameFiles& files, const Error& error) {
    if (options_.strict || !concerns_one_frame(error.code())) throw;
    std::fputs(fmt::format("polyrecon: {}: {}\n", files.label(), error.what()).c_str(), stderr);
    failed_.push_back(&files);
  }
  void skipped() { ++skipped_; }
  void written() { ++written_; }
  void fell_back(const FrameFiles& files) { fallbacks_.push_back(&files); }

  std::string summary() const {
    std::string text = fmt::format("{} written, {} skipped, {} failed", written_, skipped_, failed_.size());
    if (!fallbacks_.empty())
      text += fmt::format("; {} without all that the first frame has: {}", fallbacks_.size(), names(fallbacks_));
    return text;
  }

  void throw_if_any_failed(std::size_t all) const {
    if (!failed_.empty())
      throw Error(ExitCode::Missing,
                  fmt::format("{} of {} frames are missing or broken: {}", failed_.size(), all, names(failed_)));
  }

 private:
  /// Numbers as --frames takes them, else file names.
  static std::string names(const std::vector<const FrameFiles*>& frames) {
    std::vector<int> numbers;
    std::vector<std::string> inputs;
    for (const FrameFiles* files : frames) {
      if (files->frame) numbers.push_back(*files->frame);
      inputs.push_back(files->input);
    }
    return numbers.size() == inputs.size() ? frames_text(numbers) : fmt::format("{}", fmt::join(inputs, ", "));
  }

  const DenoiseOptions& options_;
  std::vector<const FrameFiles*> failed_, fallbacks_;
  std::size_t skipped_ = 0, written_ = 0;
};

/// Compares every frame with the first one that was read.
class Consistency {
 public:
  /// Notes in what way the frame differs; true where it has less.
  bool check(const FrameFiles& files, LoadedFrame& loaded) {
    std::set<std::string> roles;
    for (const RoleChoice& choice : loaded.in.source.chosen)
      roles.insert(choice.companion == Companion::Mean
                       ? name_of(choice.role)
                       : fmt::format("{} {}", name_of(choice.role), name_of(choice.companion)));
    const Rect& window = loaded.in.frame.data_window;
    if (first_.empty()) {
      first_ = files.label();
      roles_ = std::move(roles);
      window_ = window;
      return false;
    }
    bool less = false;
    for (const std::string& role : roles_)
      if (roles.count(role) == 0) {
        loaded.in.notes.push_back(fmt::format("no {}, which {} has: worked without it", role, first_));
        less = true;
      }
    if (window.width() != window_.width() || window.height() != window_.height())
      loaded.in.notes.push_back(fmt::format("{} x {} pixels, {} has {} x {}", window.width(), window.height(), first_,
                                            window_.width(), window_.height()));
    return less;
  }

 private:
  std::string first_;
  std::set<std::string> roles_;
  Rect window_;
};

/// Reads one frame while another is computed.
class ReadAhead {
 public:
  ReadAhead(const DenoiseOptions& options, const Progress& progress)
      : fetcher_(options, [this, &progress] { return stop_ || progress.cancelled(); }) {}
  ~ReadAhead() { stop_ = true; }

  void begin(const FrameFiles& files) {
    next_ = std::async(std::launch::async, [this, &files] { return fetcher_.fetch(files); });
  }
  /// Waits for the frame begun last; throws what fetch_frame threw.
  std::optional<LoadedFrame> take() { return next_.get(); }

 private:
  FrameFetcher fetcher_;
  std::atomic<bool> stop_{false};
  std::future<std::optional<LoadedFrame>> next_;  // last: its destructor waits for the thread
};

/// What the frame in hand may use while the next one, taken to be of its size, is read beside it.
std::size_t memory_beside_next(const Frame& frame, const Params& params) {
  const FrameShape shape = shape_of(frame);
  const std::size_t next = shape.pixels * static_cast<std::size_t>(channels_ahead(shape, params)) * sizeof(Real);
  return params.max_memory > next ? params.max_memory - next : 0;
}

}  // namespace

void run_sequence(const std::vector<FrameFiles>& frames, const DenoiseOptions& options, RunProgress& progress) {
  Outcome outcome(options);
  Consistency consistency;
  ReadAhead ahead(options, progress);
  ahead.begin(frames.front());
  for (std::size_t k = 0; k < frames.size(); ++k) {
    const FrameFiles& files = frames[k];
    progress.frame(files.label(), k, frames.size());
    std::optional<LoadedFrame> loaded;
    bool failed = false;
    try {
      loaded = ahead.take();
    } catch (const Error& error) {
      outcome.failed(files, error);
      failed = true;
    }
    if (k + 1 < frames.size()) ahead.begin(frames[k + 1]);
    if (failed) continue;
    if (!loaded) {
      outcome.skipped();
      continue;
    }
    try {
      if (consistency.check(files, *loaded)) outcome.fell_back(files);
      DenoiseOptions mine = options_for(files, options);
      if (k + 1 < frames.size()) mine.max_memory = memory_beside_next(loaded->in.frame, params_of(mine));
      denoise_frame(files, std::move(*loaded), mine, progress);
      outcome.written();
    } catch (const Error& error) {
      outcome.failed(files, error);
    }
  }
  progress.frame("", frames.size(), frames.size());
  if (!options.quiet) std::fputs((outcome.summary() + "\n").c_str(), stdout);
  outcome.throw_if_any_failed(frames.size());
}

void show_dry_run(const std::vector<FrameFiles>& frames, const DenoiseOptions& options) {
  Outcome outcome(options);
  for (const FrameFiles& files : frames) try {
      const ReadResult plan = read_frame_header(files.input, options.read);
      const bool skip = options.skip_existing && is_finished(files, options_for(files, options));
      std::fputs(fmt::format("{}: {} -> {}{}\n", files.label(), files.input, files.output,
                             skip ? ", finished already: skipped" : "")
                     .c_str(),
                 stdout);
    } catch (const Error& error) {
      outcome.failed(files, error);
    }
  outcome.throw_if_any_failed(frames.size());
}

}  // namespace polyrecon
