#include "cli/common/steps_option.h"

#include <fmt/format.h>

#include <algorithm>
#include <sstream>
#include <vector>

#include "core/nearest.h"
#include "polyrecon/error.h"

namespace polyrecon {
namespace {

/// All steps: the features by name, then the others.
std::vector<std::string> step_names() {
  std::vector<std::string> names;
  for (const RoleInfo& info : role_table())
    if (info.feature) names.emplace_back(info.name);
  for (const char* step : {"prefilter", "fireflies", "levels", "stages"}) names.emplace_back(step);
  return names;
}

std::vector<std::string> words_of(const std::string& list) {
  std::vector<std::string> words;
  std::istringstream stream(list);
  for (std::string word; std::getline(stream, word, ',');) words.push_back(word);
  return words;
}

}  // namespace

void add_steps_option(OptionSet& set, std::string& text) {
  set.add(Changes::Result, "--steps", text,
          fmt::format("Steps that run: auto (those that the frame needs), all, or a list of {}",
                      fmt::join(step_names(), ",")))
      ->type_name("auto|all|LIST")
      ->default_str("auto");
  set.add_alias(
      "--effects", [&text](const std::string& given) { text = given; }, "");
}

Params StepsChoice::applied_to(Params params) const {
  params.steps = steps;
  if (!levels) params.levels = 1;
  if (!stages) params.stages = 1;
  return params;
}

StepsChoice parse_steps(const std::string& text) {
  StepsChoice choice;
  if (text.empty() || text == "auto") return choice;
  choice.steps.decide = false;
  if (text == "all") return choice;
  const std::vector<std::string> words = words_of(text), names = step_names();
  for (const std::string& word : words)
    if (std::find(names.begin(), names.end(), word) == names.end())
      throw Error(ExitCode::Usage, fmt::format("--steps: '{}' is no step; name auto, all, or some of {}{}", word,
                                               fmt::join(names, ", "), did_you_mean(word, names)));
  const auto listed = [&](const char* name) { return std::find(words.begin(), words.end(), name) != words.end(); };
  for (const RoleInfo& info : role_table())
    if (info.feature && !listed(info.name)) choice.steps.features.erase(info.role);
  choice.steps.prefilter = listed("prefilter");
  choice.steps.fireflies = listed("fireflies");
  choice.levels = listed("levels");
  choice.stages = listed("stages");
  return choice;
}

}  // namespace polyrecon
