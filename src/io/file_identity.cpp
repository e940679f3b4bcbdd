#include "io/file_identity.h"

#include <OpenImageIO/hash.h>
#include <fmt/format.h>

#include <cstddef>
#include <filesystem>
#include <fstream>
#include <vector>

#include "polyrecon/error.h"

namespace polyrecon {

std::string file_identity(const std::string& path) {
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored)) throw Error(ExitCode::Missing, path + ": no such file");
  std::ifstream file(path, std::ios::binary);
  // The file is hashed in blocks, because it may not fit into memory. The hash of a block seeds the next one.
  std::vector<char> block(std::size_t{4} << 20);
  unsigned long long hash = 0, bytes = 0;
  while (file) {
    file.read(block.data(), static_cast<std::streamsize>(block.size()));
    const auto count = static_cast<std::size_t>(file.gcount());
    if (count == 0) break;
    hash = OIIO::xxhash::XXH64(block.data(), count, hash);
    bytes += count;
  }
  if (!file.eof()) throw Error(ExitCode::BadInput, path + ": cannot be read, check its permissions");
  return fmt::format("{}, {} bytes, xxh64 {:016x}", std::filesystem::path(path).filename().string(), bytes, hash);
}

}  // namespace polyrecon
