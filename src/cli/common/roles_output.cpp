#include "cli/common/roles_output.h"

#include <fmt/format.h>

namespace polyrecon {

std::string roles_text(const FrameSource& source) {
  std::string text;
  for (const RoleChoice& choice : source.chosen) {
    const std::string layer = choice.layer.empty() ? "(no name)" : choice.layer;
    if (choice.companion == Companion::Mean)
      text += (text.empty() ? "" : "\n") + fmt::format("  {:<26} {} ({})", name_of(choice.role), layer, choice.why);
    else
      text += fmt::format("\n  {:<26} {}", fmt::format("  {}", name_of(choice.companion)), layer);
  }
  return text + "\n";
}

nlohmann::ordered_json roles_json(const FrameSource& source) {
  auto roles = nlohmann::ordered_json::array();
  for (const RoleChoice& choice : source.chosen)
    roles.push_back({{"role", name_of(choice.role)},
                     {"holds", name_of(choice.companion)},
                     {"layer", choice.layer},
                     {"in_fit", info_of(choice.role).in_fit},
                     {"why", choice.why}});
  return roles;
}

}  // namespace polyrecon
