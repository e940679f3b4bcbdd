// Runs the program's main function in a child for each request on the standard input, which saves the attacks the time
// that linking the program takes. A request is the number of its bytes and a line's end, then texts that each end with
// a zero: the folder to run in, the files for standard output and standard error, and the arguments. The answer is a
// line with the status of wait() and the largest resident size in kilobytes.

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

/// The main function of src/main.cpp, which is compiled under this name.
int polyrecon_main(int argc, char** argv);

namespace {

constexpr unsigned most_seconds = 300;  // of the clock
constexpr rlim_t most_processor_seconds = 60;

std::vector<std::string> read_request() {
  std::size_t size = 0;
  if (std::scanf("%zu", &size) != 1 || std::getchar() != '\n') return {};
  std::string bytes(size, '\0');
  if (std::fread(bytes.data(), 1, size, stdin) != size) return {};
  std::vector<std::string> texts;
  for (std::size_t begin = 0, end = 0; (end = bytes.find('\0', begin)) != std::string::npos; begin = end + 1)
    texts.push_back(bytes.substr(begin, end - begin));
  return texts;
}

void redirect(const std::string& path, int descriptor) {
  const int file = ::open(path.c_str(), O_CREAT | O_TRUNC | O_WRONLY | O_CLOEXEC, 0600);
  if (file < 0 || ::dup2(file, descriptor) < 0) std::_Exit(127);
  ::close(file);
}

[[noreturn]] void run(std::vector<std::string>& request) {
  const rlimit time{most_processor_seconds, most_processor_seconds};
  const rlimit core{0, 0};
  if (::setrlimit(RLIMIT_CPU, &time) != 0 || ::setrlimit(RLIMIT_CORE, &core) != 0) std::_Exit(127);
  ::alarm(most_seconds);
  if (::chdir(request[0].c_str()) != 0) std::_Exit(127);
  redirect("/dev/null", STDIN_FILENO);
  redirect(request[1], STDOUT_FILENO);
  redirect(request[2], STDERR_FILENO);
  std::vector<char*> arguments{const_cast<char*>("polyrecon")};
  for (std::size_t i = 3; i < request.size(); ++i) arguments.push_back(request[i].data());
  arguments.push_back(nullptr);
  std::exit(polyrecon_main(static_cast<int>(arguments.size()) - 1, arguments.data()));
}

}  // namespace

int main() {
  for (;;) {
    std::vector<std::string> request = read_request();
    if (request.size() < 4) return 0;
    const pid_t child = ::fork();
    if (child < 0) return 1;
    if (child == 0) run(request);
    int status = 0;
    rusage usage{};
    if (::wait4(child, &status, 0, &usage) != child) return 1;
    std::printf("%d %ld\n", status, usage.ru_maxrss);
    std::fflush(stdout);
  }
}
