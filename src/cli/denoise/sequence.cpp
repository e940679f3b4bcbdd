#include "cli/denoise/sequence.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <atomic>
#include <cstdio>
#include <exception>
#include <functional>
#include <future>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include "cli/common/current_error.h"
#include "cli/common/frame_names.h"
#include "cli/common/printed_text.h"
#include "cli/denoise/fetch_frame.h"
#include "cli/denoise/file_run.h"
#include "cli/denoise/finished.h"
#include "pipeline/memory.h"
#include "polyrecon/error.h"

namespace polyrecon {
namespace {

/// A longer reason for which several frames fail is printed for the first of them only.
constexpr std::size_t most_repeated = 60;

/// Counts the frames that were written, skipped or failed, and those that lacked a layer of the first frame.
class Outcome {
 public:
  Outcome(const Job& job, RunProgress& progress) : strict_(job.run.strict), gaps_(job.gaps), progress_(progress) {}

  /// Call it inside a catch block.
  void failed(const FrameFiles& files, const Error& error) {
    if (strict_ || !concerns_one_frame(error.code())) throw;
    std::string reason = error.what();
    const std::string path = files.input + ": ";
    // A mistyped layer is missing in every frame, and its message lists all layers that there are.
    if (reason.compare(0, path.size(), path) == 0 && reason.size() > path.size() + most_repeated) {
      const auto [first, is_new] = reasons_.emplace(reason.substr(path.size()), files.label());
      if (!is_new) reason = path + "as " + first->second;
    }
    progress_.print(stderr, text_line("polyrecon: {}: {}", files.label(), reason));
    failed_.push_back(&files);
  }
  void skipped() { ++skipped_; }
  void written(const FrameFiles& files, bool missed) {
    ++written_;
    if (missed) missed_.push_back(&files);
  }
  bool any_missed() const { return !missed_.empty(); }
  void lacks_layers(const FrameFiles& files) { lacking_.push_back(&files); }

  std::string summary() const {
    std::string text = fmt::format("{} written, {} skipped, {} failed", written_, skipped_, failed_.size());
    if (!lacking_.empty())
      text += fmt::format("; {} without all layers of the first frame: {}", lacking_.size(), names(lacking_));
    if (!missed_.empty())
      text += fmt::format("; {} beyond --time-budget or --target: {}", missed_.size(), names(missed_));
    return text + gaps_text("; ");
  }

  /// The frames that have no file, after `before`; empty where there are none.
  std::string gaps_text(const char* before) const {
    return gaps_.empty() ? "" : fmt::format("{}no files of frames {}", before, frames_text(gaps_));
  }

  void throw_if_any_failed(std::size_t all) const {
    if (!failed_.empty())
      throw Error(ExitCode::Missing,
                  fmt::format("{} of {} frames are missing or broken: {}", failed_.size(), all, names(failed_)));
  }

 private:
  /// The frames as --frames takes them, or their file names where a number is unknown.
  static std::string names(const std::vector<const FrameFiles*>& frames) {
    std::vector<int> numbers;
    std::vector<std::string> inputs;
    for (const FrameFiles* files : frames) {
      if (files->frame) numbers.push_back(*files->frame);
      inputs.push_back(files->input);
    }
    return numbers.size() == inputs.size() ? frames_text(numbers) : fmt::format("{}", fmt::join(inputs, ", "));
  }

  const bool strict_;
  const std::vector<int> gaps_;
  RunProgress& progress_;
  std::vector<const FrameFiles*> failed_, lacking_, missed_;
  std::map<std::string, std::string> reasons_;  ///< The first frame that failed for each.
  std::size_t skipped_ = 0, written_ = 0;
};

/// Compares every frame with the first one that was read.
class Consistency {
 public:
  /// Adds a note for each difference. Returns whether the frame lacks a layer.
  bool check(const FrameFiles& files, LoadedFrame& loaded) {
    std::set<std::string> roles;
    for (const RoleChoice& choice : loaded.in.source.chosen)
      roles.insert(choice.companion == Companion::Mean
                       ? name_of(choice.role)
                       : fmt::format("{} {}", name_of(choice.role), name_of(choice.companion)));
    for (const LayerView& place : loaded.in.source.pictures)
      if (const std::string name = name_of(place); !name.empty()) roles.insert(name);
    const Rect& window = loaded.in.frame.data_window;
    if (first_.empty()) {
      first_ = files.label();
      roles_ = std::move(roles);
      window_ = window;
      return false;
    }
    bool lacks = false;
    for (const std::string& role : roles_)
      if (roles.count(role) == 0) {
        loaded.in.notes.push_back(fmt::format("no {}, which {} has: denoised without it", role, first_));
        lacks = true;
      }
    if (window.width() != window_.width() || window.height() != window_.height())
      loaded.in.notes.push_back(fmt::format("{} x {} pixels, {} has {} x {}", window.width(), window.height(), first_,
                                            window_.width(), window_.height()));
    return lacks;
  }

 private:
  std::string first_;
  std::set<std::string> roles_;
  Rect window_;
};

/// Reads one picture while another is computed.
class ReadAhead {
 public:
  ReadAhead(const Job& job, const Progress& progress)
      : fetcher_(job, [this, &progress] { return stop_ || progress.cancelled(); }) {}
  ~ReadAhead() { stop_ = true; }

  void begin(const FrameFiles& files) {
    wait();
    next_ = std::async(std::launch::async, [this, &files] { return fetcher_.fetch(files); });
  }
  void begin(const FrameFiles& files, const PictureChoice& picture) {
    wait();
    next_ = std::async(std::launch::async, [this, &files, picture]() -> std::optional<LoadedFrame> {
      return fetcher_.fetch(files, picture);
    });
  }
  /// Waits for the picture that was begun last. Throws as FrameFetcher::fetch.
  std::optional<LoadedFrame> take() { return next_.get(); }

 private:
  /// Waits for a picture that nobody took, as one of the same file failed.
  void wait() {
    if (next_.valid()) next_.wait();
  }

  FrameFetcher fetcher_;
  std::atomic<bool> stop_{false};
  std::future<std::optional<LoadedFrame>> next_;  // last: its destructor waits for the thread
};

/// The limit of memory for a frame while the next one, which is assumed to have the same size, is read.
std::size_t memory_with_next(const Frame& frame, const Params& params) {
  const FrameShape shape = shape_of(frame);
  const std::size_t next = shape.pixels * static_cast<std::size_t>(channels_ahead(shape, params)) * sizeof(Real);
  return params.max_memory > next ? params.max_memory - next : 0;
}

/// Denoises the pictures of frame k, of which the first is read already or being read. Each is computed while the next
/// one is read; begin_next() starts reading the next frame. Returns whether a limit was missed.
bool denoise_frame(const Job& job, const FrameFiles& files, bool is_last, LoadedFrame loaded, ReadAhead& ahead,
                   const std::function<void()>& begin_next, RunProgress& progress) {
  FileRun run(job, files);
  for (;;) {
    run.list_others(loaded);
    const auto next = run.next();
    next ? ahead.begin(files, *next) : begin_next();
    const std::size_t memory = is_last && !next ? job.params.max_memory : memory_with_next(loaded.in.frame, job.params);
    run.denoise(std::move(loaded), memory, progress);
    if (!next) break;
    loaded = *ahead.take();
  }
  return run.write(progress);
}

/// Denoises frame k, which is read already or being read, and starts reading the next one.
void run_frame(const Job& job, std::size_t k, ReadAhead& ahead, Consistency& consistency, Outcome& outcome,
               RunProgress& progress) {
  const FrameFiles& files = job.frames[k];
  const bool is_last = k + 1 == job.frames.size();
  bool begun = is_last;
  const auto begin_next = [&] {
    if (!begun) ahead.begin(job.frames[k + 1]);
    begun = true;
  };
  try {
    auto loaded = ahead.take();
    if (loaded) {
      if (consistency.check(files, *loaded)) outcome.lacks_layers(files);
      outcome.written(files, denoise_frame(job, files, is_last, std::move(*loaded), ahead, begin_next, progress));
    } else {
      outcome.skipped();
    }
  } catch (const std::exception&) {
    outcome.failed(files, current_error());
  }
  begin_next();
}

}  // namespace

bool concerns_one_frame(ExitCode code) {
  return code == ExitCode::BadInput || code == ExitCode::Missing || code == ExitCode::CheckFailed ||
         code == ExitCode::OutOfMemory || code == ExitCode::Internal;
}

bool run_sequence(const Job& job, RunProgress& progress) {
  Outcome outcome(job, progress);
  Consistency consistency;
  ReadAhead ahead(job, progress);
  ahead.begin(job.frames.front());
  const std::size_t count = job.frames.size();
  for (std::size_t k = 0; k < count; ++k) {
    progress.frame(job.frames[k].label(), k, count);
    run_frame(job, k, ahead, consistency, outcome, progress);
  }
  progress.frame("", count, count);
  if (job.run.verbosity != Verbosity::Quiet) progress.print(stdout, text_line("{}", outcome.summary()));
  outcome.throw_if_any_failed(count);
  return outcome.any_missed();
}

void show_dry_run(const Job& job) {
  const auto progress = make_progress(ProgressStyle::None);
  Outcome outcome(job, *progress);
  for (const FrameFiles& files : job.frames) try {
      read_frame_header(files.input,
                        read_options_for(job, files.number_in_names()));  // throws where the frame would fail
      const bool skip = job.run.skip_existing && is_finished(job, files);
      if (job.run.verbosity == Verbosity::Quiet) continue;
      std::fputs(text_line("{}: {} -> {}{}", files.label(), files.input, files.outputs.picture,
                           skip ? ", finished already: skipped" : "")
                     .c_str(),
                 stdout);
    } catch (const Error& error) {
      outcome.failed(files, error);
    }
  if (const std::string gaps = outcome.gaps_text(""); !gaps.empty() && job.run.verbosity != Verbosity::Quiet)
    std::fputs(text_line("{}", gaps).c_str(), stdout);
  outcome.throw_if_any_failed(job.frames.size());
}

}  // namespace polyrecon
