#include "cli/common/progress_output.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <mutex>
#include <nlohmann/json.hpp>
#include <string>

#include "cli/common/signals.h"
#include "core/stopwatch.h"
#include "polyrecon/report.h"

namespace polyrecon {
namespace {

/// Shows nothing; cancels on a signal.
class SignalProgress : public RunProgress {
 public:
  bool cancelled() const override { return caught_signal() != 0; }
};

/// Counts the work of all threads and shows them at intervals.
class ShownProgress : public SignalProgress {
 public:
  void begin(std::string_view phase, std::size_t units) override {
    const std::lock_guard lock(mutex_);
    phase_ = phase;
    total_ = units;
    done_ = 0;
    since_begin_ = {};
    since_shown_ = {};
    show(Event::Begin);
  }
  void advance(std::size_t units) override {
    done_ += units;
    // If another thread is printing, this one continues with its work.
    const std::unique_lock lock(mutex_, std::try_to_lock);
    if (!lock || since_shown_.seconds() < seconds_between) return;
    since_shown_ = {};
    show(Event::Progress);
  }
  void end() override {
    const std::lock_guard lock(mutex_);
    show(Event::End);
  }

 protected:
  enum class Event { Begin, Progress, End };
  virtual void show(Event event) = 0;

  const std::string& phase() const { return phase_; }
  /// At most total(), which is an estimate.
  std::size_t done() const { return std::min<std::size_t>(done_, total_); }
  std::size_t total() const { return total_; }
  double seconds() const { return since_begin_.seconds(); }

 private:
  static constexpr double seconds_between = 0.1;

  std::mutex mutex_;
  std::string phase_;
  std::atomic<std::size_t> done_{0};
  std::size_t total_ = 0;
  Stopwatch since_begin_, since_shown_;
};

void put(const std::string& line) {
  std::fputs((line + "\n").c_str(), stderr);
  std::fflush(stderr);
}

class BarProgress final : public ShownProgress {
 protected:
  void show(Event event) override {
    if (!terminal_ && event != Event::End) return;
    constexpr std::size_t width = 30;
    const bool finished = event == Event::End;
    const double part = finished ? 1.0 : total() ? static_cast<double>(done()) / static_cast<double>(total()) : 0.0;
    const auto filled = static_cast<std::size_t>(part * width);
    const std::string line =
        fmt::format("{:<24} [{:<30}] {:3.0f} %  {:6.1f} s", phase(), std::string(filled, '#'), 100 * part, seconds());
    std::fputs(fmt::format("{}{}{}", terminal_ ? "\r" : "", line, finished ? "\n" : "").c_str(), stderr);
    std::fflush(stderr);
  }

 public:
  void frame(const std::string& label, std::size_t done, std::size_t total) override {
    if (total > 1 && done < total) put(fmt::format("{} ({} of {})", label, done + 1, total));
  }

 private:
  const bool terminal_ = ::isatty(STDERR_FILENO) != 0;
};

class JsonProgress final : public ShownProgress {
 protected:
  void show(Event event) override {
    const char* name = event == Event::Begin ? "begin" : event == Event::End ? "end" : "progress";
    const nlohmann::ordered_json line{{"event", name},
                                      {"phase", phase()},
                                      {"done", event == Event::End ? total() : done()},
                                      {"total", total()},
                                      {"seconds", seconds()}};
    put(line.dump());
  }

 public:
  void frame(const std::string& label, std::size_t done, std::size_t total) override {
    if (total < 2) return;
    put(nlohmann::ordered_json{{"event", "frame"}, {"frame", label}, {"done", done}, {"total", total}}.dump());
  }
};

/// Lines that an Open Job Description session reads from the output of a task, as described in
/// https://github.com/OpenJobDescription/openjd-specifications/wiki/How-Jobs-Are-Run. The percentage is that of the
/// whole run and never falls.
class OpenJdProgress final : public ShownProgress {
 protected:
  void show(Event event) override {
    // The fits take nearly all of a frame's time; the phases before and after them get 5 % each.
    constexpr double fits_begin = 0.05, fits_end = 0.95;
    if (phase() != fit_phase || !total()) return;
    const double part = event == Event::End ? 1.0 : static_cast<double>(done()) / static_cast<double>(total());
    print((static_cast<double>(frames_done_) + fits_begin + part * (fits_end - fits_begin)) /
          static_cast<double>(frames_));
  }

 public:
  void frame(const std::string& label, std::size_t done, std::size_t total) override {
    frames_done_ = done;
    frames_ = total;
    if (done < total) put(fmt::format("openjd_status: {} ({} of {})", label, done + 1, total));
    print(static_cast<double>(done) / static_cast<double>(total));
  }
  void failed(const std::string& message) override { put("openjd_fail: " + message); }

 private:
  void print(double part) {
    if (100 * part < printed_ + 0.1) return;
    printed_ = 100 * part;
    put(fmt::format("openjd_progress: {:.1f}", printed_));
  }

  std::size_t frames_done_ = 0, frames_ = 1;
  double printed_ = -1;
};

}  // namespace

void RunProgress::frame(const std::string& /*label*/, std::size_t /*done*/, std::size_t /*total*/) {}

void RunProgress::failed(const std::string& /*message*/) {}

std::unique_ptr<RunProgress> make_progress(ProgressStyle style) {
  poll_signals();
  if (style == ProgressStyle::Auto) style = ::isatty(STDERR_FILENO) != 0 ? ProgressStyle::Bar : ProgressStyle::None;
  switch (style) {
    case ProgressStyle::Bar:
      return std::make_unique<BarProgress>();
    case ProgressStyle::Json:
      return std::make_unique<JsonProgress>();
    case ProgressStyle::OpenJd:
      return std::make_unique<OpenJdProgress>();
    case ProgressStyle::Auto:
    case ProgressStyle::None:
      break;
  }
  return std::make_unique<SignalProgress>();
}

}  // namespace polyrecon
