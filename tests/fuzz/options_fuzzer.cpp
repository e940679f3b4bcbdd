// The libFuzzer target of the command line: every input is a list of words, which is parsed and checked without running
// the command. Run by tests/fuzz/run.sh.

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "cli/common/current_error.h"
#include "cli/parse.h"
#include "polyrecon/error.h"

namespace {

constexpr std::size_t most_words = 64;

/// The words between line ends.
std::vector<std::string> words_of(const std::uint8_t* data, std::size_t size) {
  std::vector<std::string> words(1);
  for (std::size_t i = 0; i < size; ++i) {
    if (data[i] == '\n') {
      if (words.size() == most_words) break;
      words.emplace_back();
    } else if (data[i] != 0) {  // The system ends an argument there.
      words.back().push_back(static_cast<char>(data[i]));
    }
  }
  return words;
}

}  // namespace

extern "C" int LLVMFuzzerInitialize(int*, char***) {
  // --help writes pages there.
  return std::freopen("/dev/null", "w", stdout) ? 0 : 1;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using polyrecon::ExitCode;
  try {
    const polyrecon::Command command = polyrecon::parse_command_line(words_of(data, size));
    if (command.check_options) command.check_options();
  } catch (const std::exception&) {
    const polyrecon::Error error = polyrecon::current_error();
    if (error.code() == ExitCode::Internal) {
      std::fprintf(stderr, "%s\n", error.what());
      std::abort();
    }
  }
  return 0;
}
