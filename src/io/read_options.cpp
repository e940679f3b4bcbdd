#include "polyrecon/read_options.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <utility>

#include "polyrecon/error.h"

namespace polyrecon {
namespace {

constexpr std::array companion_words{std::pair{"variance", Companion::VarianceOfMean},
                                     std::pair{"half-a", Companion::HalfA}, std::pair{"half-b", Companion::HalfB}};

[[noreturn]] void fail(const std::string& text) {
  std::vector<const char*> roles;
  for (const RoleInfo& info : role_table())
    if (info.chosen) roles.push_back(info.name);
  throw Error(ExitCode::Usage,
              fmt::format("--map {}: expected ROLE=LAYER with a role of {}, variance, half-a, half-b or ROLE-variance, "
                          "ROLE-half-a, ROLE-half-b",
                          text, fmt::join(roles, ", ")));
}

/// Takes the companion off the end of a word: "albedo-variance" becomes "albedo", "variance" becomes "beauty".
Companion take_companion(std::string& word) {
  for (const auto& [name, companion] : companion_words) {
    if (word == name) {
      word = name_of(Role::Beauty);
      return companion;
    }
    const std::string ending = fmt::format("-{}", name);
    if (word.size() <= ending.size() || word.compare(word.size() - ending.size(), ending.size(), ending) != 0) continue;
    word.resize(word.size() - ending.size());
    return companion;
  }
  return Companion::Mean;
}

}  // namespace

RoleMapping parse_mapping(const std::string& text) {
  const auto equals = text.find('=');
  if (equals == std::string::npos || equals + 1 == text.size()) fail(text);
  RoleMapping mapping;
  std::string word = text.substr(0, equals);
  mapping.companion = take_companion(word);
  const auto role = role_from(word);
  if (!role || !info_of(*role).chosen) fail(text);
  mapping.role = *role;
  mapping.layer = text.substr(equals + 1);
  return mapping;
}

}  // namespace polyrecon
