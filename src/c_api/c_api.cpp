// The functions of include/polyrecon/polyrecon.h: from C to Filter, and from exceptions to error codes.

#include <OpenEXR/ImfThreading.h>
#include <tbb/task_arena.h>

#include <atomic>
#include <cfenv>
#include <chrono>
#include <exception>
#include <mutex>
#include <new>
#include <string>
#include <string_view>

#include "c_api/filter.h"
#include "core/first_line.h"
#include "core/parallel.h"
#include "io/files/file.h"
#include "polyrecon/polyrecon.h"

using polyrecon::ExitCode;

namespace {

/// Serialises the calls of a user's function, which any thread may cause, and keeps their number low.
class UserProgress : public polyrecon::Progress {
 public:
  UserProgress(polyrecon_progress function, void* user) : function_(function), user_(user) {}

  void begin(std::string_view phase, std::size_t units) override {
    const std::lock_guard<std::mutex> lock(mutex_);
    phase_ = phase;
    units_ = units;
    done_ = 0;
    call();
  }
  void advance(std::size_t units) override {
    done_ += units;
    const std::unique_lock<std::mutex> lock(mutex_, std::try_to_lock);
    if (lock && Clock::now() - last_call_ >= std::chrono::milliseconds(50)) call();
  }
  void end() override {
    const std::lock_guard<std::mutex> lock(mutex_);
    done_ = units_;
    call();
  }
  bool cancelled() const override { return cancelled_; }

 private:
  using Clock = std::chrono::steady_clock;

  void call() {
    last_call_ = Clock::now();
    const double done = units_ > 0 ? static_cast<double>(done_) / static_cast<double>(units_) : 1;
    if (function_ && function_(user_, phase_.c_str(), done < 1 ? done : 1) == 0) cancelled_ = true;
  }

  polyrecon_progress function_;
  void* user_;
  std::mutex mutex_;
  std::string phase_;
  std::size_t units_ = 0;
  std::atomic<std::size_t> done_{0};
  std::atomic<bool> cancelled_{false};
  Clock::time_point last_call_;
};

/// The floating-point mode that results are defined for. Hosts set others, such as denormals as 0; threads of an arena
/// take that of the thread that made the arena.
class DefaultFloatingPoint {
 public:
  DefaultFloatingPoint() {
    std::fegetenv(&before_);
    std::fesetenv(FE_DFL_ENV);
  }
  ~DefaultFloatingPoint() { std::fesetenv(&before_); }
  DefaultFloatingPoint(const DefaultFloatingPoint&) = delete;
  DefaultFloatingPoint& operator=(const DefaultFloatingPoint&) = delete;

 private:
  std::fenv_t before_{};
};

/// OpenEXR's threads belong to the process, so they are started only where the host has started none.
void start_codec_threads() {
  static std::once_flag once;
  std::call_once(once, [] {
    if (Imf::globalThreadCount() == 0) polyrecon::set_codec_threads(polyrecon::processors());
  });
}

constexpr const char* no_filter = "the filter is null";

}  // namespace

struct polyrecon_filter {  // NOLINT(readability-identifier-naming): a name of C
  std::unique_ptr<polyrecon::Filter> work;
  polyrecon_progress progress = nullptr;
  void* user = nullptr;
  polyrecon_error error = POLYRECON_OK;
  std::string message;

  polyrecon_error fail(ExitCode code, std::string_view text) noexcept {
    error = static_cast<polyrecon_error>(code);
    try {
      message = work->in_parameters(polyrecon::first_line(std::string(text)));
    } catch (...) {
      message.clear();
    }
    return error;
  }
};

namespace {

/// Calls a function and turns what it throws into the filter's error.
template <typename Function>
polyrecon_error guarded(polyrecon_filter* filter, const Function& function) noexcept {
  if (!filter) return POLYRECON_USAGE;
  filter->error = POLYRECON_OK;
  filter->message.clear();
  try {
    function();
    return POLYRECON_OK;
  } catch (const polyrecon::Error& error) {
    return filter->fail(error.code(), error.what());
  } catch (const std::bad_alloc&) {
    return filter->fail(ExitCode::OutOfMemory, "not enough memory: lower 'max memory', or use fewer images");
  } catch (const std::exception& error) {
    return filter->fail(ExitCode::Internal, error.what());
  } catch (...) {
    return filter->fail(ExitCode::Internal, "unknown exception");
  }
}

std::string text_of(const char* name) {
  if (!name) throw polyrecon::Error(ExitCode::Usage, "a name is null");
  return name;
}

}  // namespace

const char* polyrecon_version(void) { return POLYRECON_VERSION; }

polyrecon_filter* polyrecon_new_filter(const char* kind) {
  try {
    const auto& kinds = polyrecon::filter_kinds();
    const auto found = kinds.find(text_of(kind));
    if (found == kinds.end()) return nullptr;
    auto filter = std::make_unique<polyrecon_filter>();
    filter->work = found->second();
    return filter.release();
  } catch (...) {
    return nullptr;
  }
}

void polyrecon_release_filter(polyrecon_filter* filter) { delete filter; }

polyrecon_error polyrecon_get_error(const polyrecon_filter* filter, const char** message) {
  if (message) *message = filter ? filter->message.c_str() : no_filter;
  return filter ? filter->error : POLYRECON_USAGE;
}

polyrecon_error polyrecon_set_image(polyrecon_filter* filter, const char* name, const polyrecon_image* image) {
  return guarded(filter, [&] { filter->work->set_image(text_of(name), image ? *image : polyrecon_image{}); });
}

polyrecon_error polyrecon_set_text(polyrecon_filter* filter, const char* name, const char* value) {
  return guarded(filter, [&] {
    const std::string text = value ? value : "";
    filter->work->set_text(text_of(name), value ? &text : nullptr);
  });
}

polyrecon_error polyrecon_set_number(polyrecon_filter* filter, const char* name, double value) {
  return guarded(filter, [&] { filter->work->set_number(text_of(name), value); });
}

polyrecon_error polyrecon_set_progress(polyrecon_filter* filter, polyrecon_progress progress, void* user) {
  return guarded(filter, [&] {
    filter->progress = progress;
    filter->user = user;
  });
}

polyrecon_error polyrecon_execute(polyrecon_filter* filter) {
  return guarded(filter, [&] {
    start_codec_threads();
    UserProgress progress(filter->progress, filter->user);
    const DefaultFloatingPoint floating_point;
    const int threads = filter->work->threads();
    tbb::task_arena arena(threads > 0 ? threads : tbb::task_arena::automatic);
    arena.execute([&] { filter->work->execute(progress); });
  });
}

int polyrecon_image_count(const polyrecon_filter* filter) {
  return filter ? static_cast<int>(filter->work->images().size()) : 0;
}

const char* polyrecon_image_name(const polyrecon_filter* filter, int index) {
  return index >= 0 && index < polyrecon_image_count(filter)
             ? filter->work->images()[static_cast<std::size_t>(index)].name.c_str()
             : nullptr;
}

polyrecon_error polyrecon_describe_image(polyrecon_filter* filter, const char* name, polyrecon_image* image) {
  return guarded(filter, [&] {
    const polyrecon::Image& made = filter->work->image(text_of(name));
    if (!image) throw polyrecon::Error(ExitCode::Usage, "there is no place for the size");
    image->width = made.width();
    image->height = made.height();
    image->channels = made.channels();
  });
}

polyrecon_error polyrecon_get_image(polyrecon_filter* filter, const char* name, const polyrecon_image* target) {
  return guarded(filter, [&] {
    const polyrecon::Image& made = filter->work->image(text_of(name));
    if (!target) throw polyrecon::Error(ExitCode::Usage, "there is no place for the image");
    polyrecon::check(name, *target);
    if (target->width != made.width() || target->height != made.height() || target->channels != made.channels())
      throw polyrecon::Error(ExitCode::Usage, polyrecon::size_conflict(name, made, *target));
    polyrecon::write_memory(made, *target);
  });
}

const char* polyrecon_get_report(const polyrecon_filter* filter) {
  return filter ? filter->work->report().c_str() : "";
}
