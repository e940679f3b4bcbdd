// The libFuzzer side: every input becomes a file in memory, which is read as a stranger's. tests/fuzz/run.sh drives it.

#include <unistd.h>

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <string>

#include "fuzz/read_stranger.h"

namespace {

/// A folder in memory, removed at a normal end.
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

/// Most that one file may take, of processor time: libFuzzer's own clock runs on while others use the machine.
constexpr double kSeconds = 10;

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const Folder folder;
  const std::string file = folder.path() + "/stranger.exr";
  std::ofstream(file, std::ios::binary).write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
  const std::clock_t begin = std::clock();
  polyrecon::fuzz::read_stranger(file, folder.path());
  if (static_cast<double>(std::clock() - begin) > kSeconds * CLOCKS_PER_SEC) {
    std::fprintf(stderr, "over %g s of processor time\n", kSeconds);
    std::abort();
  }
  return 0;
}
