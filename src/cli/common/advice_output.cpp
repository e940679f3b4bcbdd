#include "cli/common/advice_output.h"

namespace polyrecon {

nlohmann::ordered_json advice_json(const std::vector<PassAdvice>& advice) {
  auto list = nlohmann::ordered_json::array();
  for (const PassAdvice& one : advice) list.push_back({{"pass", one.pass}, {"without", one.without}, {"how", one.how}});
  return list;
}

}  // namespace polyrecon
