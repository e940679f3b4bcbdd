// The libFuzzer target: every input is written to a file in memory and given to read_untrusted. Run by
// tests/fuzz/run.sh.

#include <unistd.h>

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <string>

#include "fuzz/read_untrusted.h"

namespace {

/// A folder in memory, removed at a normal exit.
class Folder {
 public:
  Folder() {
    std::string name = "/dev/shm/polyrecon-fuzz-XXXXXX";
    if (!::mkdtemp(name.data())) std::abort();
    path_ = name;
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  ~Folder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

/// Limit of processor time for one file. libFuzzer's -timeout is wall-clock time, which depends on the load.
constexpr double most_seconds = 10;

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const Folder folder;
  const std::string file = folder.path() + "/input.exr";
  std::ofstream(file, std::ios::binary).write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
  const std::clock_t begin = std::clock();
  polyrecon::fuzz::read_untrusted(file, folder.path());
  if (static_cast<double>(std::clock() - begin) > most_seconds * CLOCKS_PER_SEC) {
    std::fprintf(stderr, "over %g s of processor time\n", most_seconds);
    std::abort();
  }
  return 0;
}
