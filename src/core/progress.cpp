#include "polyrecon/progress.h"

namespace polyrecon {

void Progress::begin(std::string_view, std::size_t) {}
void Progress::advance(std::size_t) {}
void Progress::end() {}
bool Progress::cancelled() const { return false; }

}  // namespace polyrecon
