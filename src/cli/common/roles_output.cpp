#include "cli/common/roles_output.h"

#include <fmt/format.h>

#include "cli/common/printed_text.h"

namespace polyrecon {

std::string roles_text(const FrameSource& source) {
  std::string text;
  for (const RoleChoice& choice : source.chosen) {
    const std::string layer = choice.layer.empty() ? "(no name)" : choice.layer;
    text += choice.companion == Companion::Mean
                ? text_line("  {:<26} {} ({})", name_of(choice.role), layer, choice.why)
                : text_line("  {:<26} {}", fmt::format("  {}", name_of(choice.companion)), layer);
  }
  return text;
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
