#include "cli/common/decisions_output.h"

#include <fmt/format.h>

namespace polyrecon {

std::string decision_text(const Decision& decision) {
  std::string text = fmt::format("{}: {}", decision.run ? "yes" : "no", decision.reason);
  if (decision.saved_seconds > 0) text += fmt::format(", saves about {:.2g} s", decision.saved_seconds);
  return text;
}

nlohmann::ordered_json decisions_json(const std::vector<Decision>& decisions) {
  auto list = nlohmann::ordered_json::array();
  for (const Decision& d : decisions)
    list.push_back({{"step", d.step}, {"run", d.run}, {"reason", d.reason}, {"saved_seconds", d.saved_seconds}});
  return list;
}

}  // namespace polyrecon
