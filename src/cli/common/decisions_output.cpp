#include "cli/common/decisions_output.h"

#include <fmt/format.h>

namespace polyrecon {

std::string decision_text(const Decision& decision) {
  std::string text = fmt::format("{}: {}", decision.run ? "yes" : "no", decision.reason);
  if (decision.saved_seconds > 0) text += fmt::format(", saves about {:.2g} s", decision.saved_seconds);
  return text;
}

}  // namespace polyrecon
