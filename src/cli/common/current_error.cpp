#include "cli/common/current_error.h"

#include <fmt/format.h>

#include <exception>
#include <new>
#include <string>
#include <string_view>
#include <system_error>

#include "cli/common/memory_limit.h"

namespace polyrecon {
namespace {

Error no_thread() {
  return {ExitCode::OutOfMemory,
          "no thread can be started: raise --max-memory or the number of processes (ulimit -u), or lower --threads"};
}

Error internal(const std::exception& error) {
  return {ExitCode::Internal, std::string("internal error: ") + error.what()};
}

}  // namespace

Error current_error() {
  try {
    throw;
  } catch (const Error& error) {
    return error;
  } catch (const std::bad_alloc&) {
    if (memory_limit() > 0)
      return {ExitCode::OutOfMemory,
              fmt::format("more memory is needed than --max-memory {}M allows: raise it", memory_limit() >> 20)};
    return {ExitCode::OutOfMemory, "not enough memory: lower --max-memory, or use fewer passes"};
  } catch (const std::system_error& error) {
    return error.code() == std::errc::resource_unavailable_try_again ? no_thread() : internal(error);
  } catch (const std::exception& error) {
    const bool by_tbb = std::string_view(error.what()).find("pthread_create") != std::string_view::npos;
    return by_tbb ? no_thread() : internal(error);
  }
}

}  // namespace polyrecon
