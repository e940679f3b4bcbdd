#include "io/whole_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "core/error.h"

namespace polyrecon {
namespace {

namespace fs = std::filesystem;

bool flush_to_disk(const fs::path& path) {
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) return false;
  const bool flushed = ::fsync(file) == 0;
  ::close(file);
  return flushed;
}

}  // namespace

void write_whole(const std::string& target, const std::function<void(const std::string&)>& write) {
  const fs::path path(target);
  const fs::path temporary = path.parent_path() / fmt::format(".{}.{}.tmp", path.filename().string(), ::getpid());
  std::error_code error;
  try {
    write(temporary.string());
    if (!flush_to_disk(temporary)) throw Error(ExitCode::CannotWrite, target + ": could not be flushed to the disk");
    fs::rename(temporary, path, error);
    if (error) throw Error(ExitCode::CannotWrite, target + ": " + error.message());
  } catch (...) {
    fs::remove(temporary, error);
    throw;
  }
}

void write_text(const std::string& target, const std::string& text) {
  write_whole(target, [&](const std::string& temporary) {
    std::ofstream file(temporary, std::ios::binary);
    file << text;
    file.close();
    if (!file) throw Error(ExitCode::CannotWrite, target + ": could not be written");
  });
}

}  // namespace polyrecon
