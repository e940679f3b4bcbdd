#include "cli/common/progress_output.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <mutex>
#include <nlohmann/json.hpp>
#include <string>

#include "cli/common/printed_text.h"
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
  std::fputs(text_line("{}", line).c_str(), stderr);
  std::fflush(stderr);
}

/// Whether the bar stands on the last line of the terminal.
std::atomic<bool> bar_stands{false};

/// The share of a whole run that is done; it never falls.
class RunShare {
 public:
  void frame(std::size_t done, std::size_t total) {
    done_ = done;
    frames_ = total;
    raise(static_cast<double>(done_) / static_cast<double>(frames_));
  }
  /// part: the share of the fits of this frame, which take nearly all of its time; the phases before and after them get
  /// 5 % each.
  void fits(double part) {
    constexpr double fits_begin = 0.05, fits_end = 0.95;
    raise((static_cast<double>(done_) + fits_begin + part * (fits_end - fits_begin)) / static_cast<double>(frames_));
  }
  /// The share of the only phase of a run without frames.
  void phase(double part) { share_ = part; }
  double value() const { return share_; }
  std::size_t done() const { return done_; }
  std::size_t frames() const { return frames_; }

 private:
  void raise(double share) { share_ = std::max(share_, share); }

  std::size_t done_ = 0, frames_ = 0;  ///< Without frames a run has one phase.
  double share_ = 0;
};

/// "1:05:09", "2:07".
std::string clock_text(double seconds) {
  const long long whole = std::llround(seconds);
  if (whole >= 3600) return fmt::format("{}:{:02}:{:02}", whole / 3600, whole / 60 % 60, whole % 60);
  return fmt::format("{}:{:02}", whole / 60, whole % 60);
}

/// Progress for people: frames, per cent, and the time that is left as the time so far predicts it.
class PeopleProgress : public ShownProgress {
 public:
  void frame(const std::string& label, std::size_t done, std::size_t total) override {
    share_.frame(done, total);
    label_ = done < total ? label : "";
  }

 protected:
  void follow(Event event) {
    if (!total()) return;
    const double part = event == Event::End ? 1.0 : static_cast<double>(done()) / static_cast<double>(total());
    if (share_.frames() == 0)
      share_.phase(part);
    else if (phase() == fit_phase)
      share_.fits(part);
  }
  std::string where() const {
    return share_.frames() > 1 ? fmt::format("{}, {} of {}", label_, share_.done() + 1, share_.frames()) : phase();
  }
  /// The time so far and the time left; the latter is unknown in the first per cent.
  std::string times() const {
    const double share = share_.value(), spent = since_start_.seconds();
    std::string text = clock_text(spent);
    if (share > 0.01) text += fmt::format(", {} left", clock_text(spent * (1 - share) / share));
    return text;
  }
  const RunShare& share() const { return share_; }
  bool in_frame() const { return !label_.empty(); }

 private:
  RunShare share_;
  std::string label_;
  Stopwatch since_start_;
};

/// One line of a terminal, redrawn; what is printed stands above it.
class BarProgress final : public PeopleProgress {
 public:
  ~BarProgress() override { clear(); }
  void frame(const std::string& label, std::size_t done, std::size_t total) override {
    PeopleProgress::frame(label, done, total);
    if (!in_frame()) clear();
  }
  void print(std::FILE* stream, const std::string& text) override {
    clear();
    PeopleProgress::print(stream, text);
  }

 protected:
  void show(Event event) override {
    follow(event);
    constexpr std::size_t width = 30;
    const auto filled = static_cast<std::size_t>(share().value() * width);
    const std::string line = fmt::format("[{:<30}] {:3.0f} %  {}  {}", std::string(filled, '#'), 100 * share().value(),
                                         printable(where()), times());
    std::fputs(fmt::format("\r\x1b[K{}", line).c_str(), stderr);
    std::fflush(stderr);
    bar_stands = true;
  }

 private:
  static void clear() {
    if (!bar_stands.exchange(false)) return;
    std::fputs("\r\x1b[K", stderr);
    std::fflush(stderr);
  }
};

/// A line for a log, at most once a minute.
class LogProgress final : public PeopleProgress {
 protected:
  void show(Event event) override {
    follow(event);
    constexpr double seconds_between_lines = 60;
    if (since_line_.seconds() < seconds_between_lines) return;
    since_line_ = {};
    put(fmt::format("polyrecon: {:.0f} %, {}, {}", 100 * share().value(), where(), times()));
  }

 private:
  Stopwatch since_line_;
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
    put(json_line(line));
  }

 public:
  void frame(const std::string& label, std::size_t done, std::size_t total) override {
    if (total < 2) return;
    put(json_line({{"event", "frame"}, {"frame", label}, {"done", done}, {"total", total}}));
  }
};

/// Lines that an Open Job Description session reads from the output of a task, as described in
/// https://github.com/OpenJobDescription/openjd-specifications/wiki/How-Jobs-Are-Run. The percentage is that of the
/// whole run and never falls.
class OpenJdProgress final : public ShownProgress {
 protected:
  void show(Event event) override {
    if (phase() != fit_phase || !total()) return;
    share_.fits(event == Event::End ? 1.0 : static_cast<double>(done()) / static_cast<double>(total()));
    print_share();
  }

 public:
  void frame(const std::string& label, std::size_t done, std::size_t total) override {
    share_.frame(done, total);
    if (done < total) put(fmt::format("openjd_status: {} ({} of {})", label, done + 1, total));
    print_share();
  }
  void failed(const std::string& message) override { put("openjd_fail: " + message); }

 private:
  void print_share() {
    if (100 * share_.value() < printed_ + 0.1) return;
    printed_ = 100 * share_.value();
    put(fmt::format("openjd_progress: {:.1f}", printed_));
  }

  RunShare share_;
  double printed_ = -1;
};

}  // namespace

void RunProgress::frame(const std::string& /*label*/, std::size_t /*done*/, std::size_t /*total*/) {}

void RunProgress::failed(const std::string& /*message*/) {}

void RunProgress::print(std::FILE* stream, const std::string& text) {
  std::fputs(text.c_str(), stream);
  std::fflush(stream);
}

void end_progress_line() {
  if (!bar_stands.exchange(false)) return;
  [[maybe_unused]] const auto written = ::write(STDERR_FILENO, "\n", 1);
}

std::unique_ptr<RunProgress> make_progress(ProgressStyle style) {
  poll_signals();
  switch (style) {
    case ProgressStyle::Bar:
      if (::isatty(STDERR_FILENO) != 0) return std::make_unique<BarProgress>();
      return std::make_unique<LogProgress>();
    case ProgressStyle::Json:
      return std::make_unique<JsonProgress>();
    case ProgressStyle::OpenJd:
      return std::make_unique<OpenJdProgress>();
    case ProgressStyle::None:
      break;
  }
  return std::make_unique<SignalProgress>();
}

}  // namespace polyrecon
