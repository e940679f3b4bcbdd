#include "polyrecon/progress.h"

namespace polyrecon {

void Progress::begin(std::string_view, std::size_t) {}
void Progress::advance(std::size_t) {}
void Progress::end() {}
bool Progress::cancelled() const { return false; }

Progress& silent_progress() {
  static Progress silent;  // stateless, so all callers can share it
  return silent;
}

}  // namespace polyrecon
