// A library for LD_PRELOAD. The call with number FAIL_AT of the kind FAIL_CALL (write, fsync, close, rename) fails as
// on a full disk, and the file FAIL_MARK is then created. Only calls on temporary files of polyrecon and their folder
// count.

#include <dlfcn.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <sys/uio.h>
#include <unistd.h>

#include <cerrno>
#include <climits>
#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace {

template <typename Function>
Function* next(const char* name) {
  return reinterpret_cast<Function*>(::dlsym(RTLD_NEXT, name));
}

bool is_output(int descriptor) {
  char link[64], path[PATH_MAX + 1] = {};
  std::snprintf(link, sizeof link, "/proc/self/fd/%d", descriptor);
  if (::readlink(link, path, PATH_MAX) < 0) return false;
  struct ::stat about {};
  return std::strstr(path, ".polyrecon-") || (::stat(path, &about) == 0 && S_ISDIR(about.st_mode));
}

/// Counts a call of this kind; true if it is the one that must fail.
bool fails(const char* call) {
  static int count = 0;
  const char *kind = std::getenv("FAIL_CALL"), *at = std::getenv("FAIL_AT"), *mark = std::getenv("FAIL_MARK");
  if (!kind || !at || !mark || std::strcmp(kind, call) != 0 || ++count != std::atoi(at)) return false;
  ::close(::open(mark, O_CREAT | O_WRONLY, 0600));
  errno = ENOSPC;
  return true;
}

}  // namespace

extern "C" {

ssize_t write(int descriptor, const void* data, std::size_t size) {
  if (is_output(descriptor) && fails("write")) return -1;
  return next<ssize_t(int, const void*, std::size_t)>("write")(descriptor, data, size);
}

ssize_t writev(int descriptor, const iovec* data, int count) {
  if (is_output(descriptor) && fails("write")) return -1;
  return next<ssize_t(int, const iovec*, int)>("writev")(descriptor, data, count);
}

int fsync(int descriptor) {
  if (is_output(descriptor) && fails("fsync")) return -1;
  return next<int(int)>("fsync")(descriptor);
}

/// Closes the file even if it reports a failure, as Linux does.
int close(int descriptor) {
  const bool output = is_output(descriptor);
  const int result = next<int(int)>("close")(descriptor);
  return output && fails("close") ? -1 : result;
}

int rename(const char* from, const char* to) {
  if (std::strstr(from, ".polyrecon-") && fails("rename")) return -1;
  return next<int(const char*, const char*)>("rename")(from, to);
}

}  // extern "C"
