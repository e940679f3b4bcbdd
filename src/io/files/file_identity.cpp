#include "io/files/file_identity.h"

#include <OpenImageIO/hash.h>
#include <fmt/format.h>
#include <sys/stat.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <vector>

#include "io/files/missing_file.h"
#include "polyrecon/error.h"

namespace polyrecon {
namespace {

std::int64_t nanoseconds(const timespec& time) { return std::int64_t{time.tv_sec} * 1000000000 + time.tv_nsec; }

}  // namespace

FileStamp stamp_of(const std::string& path) {
  struct stat found = {};
  if (::stat(path.c_str(), &found) != 0) return {};
  return {found.st_dev, found.st_ino, static_cast<std::uint64_t>(found.st_size), nanoseconds(found.st_mtim),
          nanoseconds(found.st_ctim)};
}

void require_unchanged(const FileInfo& file) {
  if (!(stamp_of(file.path) == file.stamp))
    throw Error(ExitCode::BadInput, fmt::format("{}: was changed while it was in use; run again", file.path));
}

std::string file_identity(const std::string& path) {
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored)) throw missing_file(path);
  if (!std::filesystem::is_regular_file(path, ignored)) throw Error(ExitCode::BadInput, path + ": not a file");
  std::ifstream file(path, std::ios::binary);
  // The file is hashed in blocks, because it may not fit into memory. The hash of a block seeds the next one.
  std::vector<char> block(std::size_t{4} << 20);
  // Files of the system may be of no size and without an end, so no more than the size is read.
  const std::uintmax_t size = std::filesystem::file_size(path, ignored);
  unsigned long long hash = 0, bytes = 0;
  while (bytes < size) {
    const auto wanted = static_cast<std::size_t>(std::min<std::uintmax_t>(block.size(), size - bytes));
    file.read(block.data(), static_cast<std::streamsize>(wanted));
    const auto count = static_cast<std::size_t>(file.gcount());
    if (count < wanted) throw Error(ExitCode::BadInput, path + ": cannot be read, check its permissions");
    hash = OIIO::xxhash::XXH64(block.data(), count, hash);
    bytes += count;
  }
  return fmt::format("{}, {} bytes, xxh64 {:016x}", std::filesystem::path(path).filename().string(), bytes, hash);
}

std::string files_identity(const std::vector<FileInfo>& files) {
  std::string text;
  for (const FileInfo& file : files) text += (text.empty() ? "" : "; ") + file_identity(file.path);
  return text;
}

}  // namespace polyrecon
