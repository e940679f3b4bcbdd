#include "io/files/atomic_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <system_error>

#include "core/first_line.h"
#include "io/exr/out_of_memory.h"
#include "polyrecon/error.h"

namespace polyrecon {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view temporary_mark = ".polyrecon-";
constexpr std::size_t longest_stem = 200;     ///< A name may have 255 bytes.
constexpr std::chrono::minutes stale_age{1};  ///< Younger ones may belong to a run that has not locked its file yet.

[[noreturn]] void fail(const std::string& target, const std::string& doing, int error) {
  throw Error(ExitCode::CannotWrite,
              fmt::format("{}: cannot be written ({}: {})", target, doing, std::strerror(error)));
}

fs::path folder_of(const std::string& target) {
  const fs::path parent = fs::path(target).parent_path();
  return parent.empty() ? fs::path(".") : parent;
}

/// How names of temporaries for this target begin.
std::string temporary_prefix(const std::string& target) {
  return "." + fs::path(target).filename().string().substr(0, longest_stem) + std::string(temporary_mark);
}

/// Paths of the temporaries in use, for a signal handler: it may neither lock nor allocate.
std::array<std::atomic<const char*>, 64> in_use{};

/// The slot that now holds path; nullptr where all are taken (such a file would outlive a signal, no worse than a
/// crash).
std::atomic<const char*>* remember(const char* path) {
  for (auto& slot : in_use) {
    const char* free = nullptr;
    if (slot.compare_exchange_strong(free, path)) return &slot;
  }
  return nullptr;
}

/// A new file next to the target that is locked as long as it is in use, and removed unless it took the target's name.
class Temporary {
 public:
  explicit Temporary(const std::string& target) : target_(target) {
    std::random_device random;
    for (int attempt = 0; attempt < 100 && descriptor_ < 0; ++attempt) {
      forget();
      path_ =
          (folder_of(target) / fmt::format("{}{:08x}{:08x}", temporary_prefix(target), random(), random())).string();
      slot_ = remember(path_.c_str());
      descriptor_ = ::open(path_.c_str(), O_CREAT | O_EXCL | O_RDWR | O_CLOEXEC, 0666);
      if (descriptor_ < 0 && errno != EEXIST) break;
    }
    if (descriptor_ < 0) {
      const int error = errno;
      forget();
      fail(target, "making a file in its folder", error);
    }
    ::flock(descriptor_, LOCK_EX | LOCK_NB);
  }
  Temporary(const Temporary&) = delete;
  Temporary& operator=(const Temporary&) = delete;
  ~Temporary() {
    if (!renamed_) ::unlink(path_.c_str());
    forget();
    ::close(descriptor_);
  }

  const std::string& path() const { return path_; }

  void flush() {
    if (::fsync(descriptor_) != 0) fail(target_, "flushing it to disk", errno);
    // Some network file systems report a full disk only when a descriptor is closed; the lock keeps the other one.
    const int copy = ::dup(descriptor_);
    if (copy < 0 || ::close(copy) != 0) fail(target_, "closing it", errno);
  }

  void take_name_of_target() {
    struct ::stat old {};
    if (::stat(target_.c_str(), &old) == 0 && S_ISREG(old.st_mode)) ::fchmod(descriptor_, old.st_mode & 07777);
    if (std::rename(path_.c_str(), target_.c_str()) != 0) fail(target_, "renaming it", errno);
    renamed_ = true;
  }

 private:
  void forget() {
    if (slot_) slot_->store(nullptr);
    slot_ = nullptr;
  }

  std::string target_, path_;
  int descriptor_ = -1;
  bool renamed_ = false;
  std::atomic<const char*>* slot_ = nullptr;
};

/// The rename lasts only once the folder is on disk; file systems that cannot flush a folder say EINVAL.
void flush_folder(const std::string& target) {
  const int folder = ::open(folder_of(target).c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (folder < 0) return;  // a folder may be writable and not readable
  const bool failed = ::fsync(folder) != 0 && errno != EINVAL;
  const int error = errno;
  ::close(folder);
  if (failed) fail(target, "flushing its folder", error);
}

bool is_abandoned(const fs::path& path) {
  std::error_code failure;
  const auto changed = fs::last_write_time(path, failure);
  if (failure || fs::file_time_type::clock::now() - changed < stale_age) return false;
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW);
  if (descriptor < 0) return false;
  const bool free = ::flock(descriptor, LOCK_EX | LOCK_NB) == 0;
  ::close(descriptor);
  return free;
}

void remove_abandoned(const std::string& target) {
  const std::string prefix = temporary_prefix(target);
  std::error_code failure;
  for (fs::directory_iterator entry(folder_of(target), failure), end; !failure && entry != end;
       entry.increment(failure)) {
    if (entry->path().filename().string().compare(0, prefix.size(), prefix) != 0 || !is_abandoned(entry->path()))
      continue;
    std::error_code ignored;
    fs::remove(entry->path(), ignored);
  }
}

/// The folder of the target, or the nearest folder above it that exists.
fs::path nearest_folder(const std::string& target) {
  fs::path folder = folder_of(target);
  std::error_code failure;
  while (!fs::exists(folder, failure)) {
    if (failure == std::errc::filename_too_long) fail(target, "its folder", failure.value());
    const fs::path above = folder.parent_path();
    if (above == folder) break;
    folder = above.empty() ? fs::path(".") : above;
  }
  return folder;
}

void make_folder(const std::string& target) {
  std::error_code failure;
  fs::create_directories(folder_of(target), failure);
  if (failure) fail(target, "making its folder", failure.value());
}

void check_target(const std::string& target) {
  std::error_code failure;
  const fs::file_status status = fs::status(target, failure);
  if (target.empty() || fs::path(target).filename().empty() || fs::is_directory(status))
    throw Error(ExitCode::CannotWrite, fmt::format("{}: cannot be written (it is a folder)", target));
  if (fs::exists(status) && !fs::is_regular_file(status))
    throw Error(ExitCode::CannotWrite, fmt::format("{}: cannot be written (it is not a regular file)", target));
}

}  // namespace

void remove_temporaries() {
  for (const auto& slot : in_use)
    if (const char* path = slot.load()) ::unlink(path);
}

void write_bytes(const std::string& target, const std::string& bytes) {
  const auto write = [&](const std::string& path) { std::ofstream(path, std::ios::binary) << bytes; };
  const auto verify = [&](const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    if (std::string(std::istreambuf_iterator<char>(file), {}) != bytes)
      throw Error(ExitCode::CannotWrite, target + ": cannot be read back, is the disk full?");
  };
  write_atomically(target, write, verify);
}

void check_writable(const std::string& target) {
  check_target(target);
  try {
    const Temporary probe((nearest_folder(target) / fs::path(target).filename()).string());
  } catch (const Error& problem) {  // It names the file as one of the folder that exists.
    if (nearest_folder(target) == folder_of(target)) throw;
    throw Error(problem.code(),
                fmt::format("{}: its folder cannot be made in {}", target, nearest_folder(target).string()));
  }
}

void write_atomically(const std::string& target, const std::function<void(const std::string& path)>& write,
                      const std::function<void(const std::string& path)>& verify) {
  check_target(target);
  make_folder(target);
  remove_abandoned(target);
  Temporary temporary(target);
  try {
    write(temporary.path());
    temporary.flush();
    verify(temporary.path());
  } catch (const Error&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& problem) {
    throw_if_out_of_memory(problem);
    throw Error(ExitCode::CannotWrite, fmt::format("{}: cannot be written ({})", target, first_line(problem.what())));
  }
  temporary.take_name_of_target();
  flush_folder(target);
}

}  // namespace polyrecon
