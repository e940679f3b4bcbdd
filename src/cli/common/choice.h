#pragma once

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <map>
#include <string>
#include <vector>

namespace polyrecon {

/// An option that takes one of the names; value is set to what stands beside it. Its type reads "draft|standard", which
/// is what the help shows and the shell completions offer.
template <typename Value>
CLI::Option* add_choice(CLI::App& app, const std::string& option, Value& value,
                        const std::map<std::string, Value>& names, const std::string& help) {
  std::vector<std::string> keys;
  for (const auto& [name, unused] : names) keys.push_back(name);
  return app
      .add_option_function<std::string>(
          option, [&value, names](const std::string& name) { value = names.at(name); }, help)
      ->check(CLI::IsMember(keys).description(""))
      ->type_name(fmt::format("{}", fmt::join(keys, "|")));
}

}  // namespace polyrecon
