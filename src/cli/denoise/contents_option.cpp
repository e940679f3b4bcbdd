#include "cli/denoise/contents_option.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <sstream>
#include <vector>

#include "core/nearest.h"
#include "polyrecon/error.h"

namespace polyrecon {
namespace {

/// A word of the list, and what it sets.
struct Word {
  const char* name;
  void (*apply)(ResultContents&);
  bool says_what_is_kept;
};

const std::vector<Word>& known_words() {
  static const std::vector<Word> words{
      {"beauty", [](ResultContents&) {}, true},
      {"layers", [](ResultContents& c) { c.layers = true; }, true},
      {"input", [](ResultContents& c) { c.layers = c.working = true; }, true},
      {"noisy", [](ResultContents& c) { c.noisy = true; }, false},
      {"error", [](ResultContents& c) { c.error = true; }, false},
      {"order", [](ResultContents& c) { c.order = true; }, false},
  };
  return words;
}

}  // namespace

ResultContents parse_contents(const std::string& list) {
  ResultContents contents;
  contents.layers = contents.working = false;
  bool known = false;
  std::istringstream stream(list);
  for (std::string name; std::getline(stream, name, ',');) {
    const auto word =
        std::find_if(known_words().begin(), known_words().end(), [&](const Word& w) { return w.name == name; });
    if (word == known_words().end()) {
      std::vector<std::string> names;
      for (const Word& w : known_words()) names.emplace_back(w.name);
      throw Error(ExitCode::Usage, fmt::format("--outputs: {} is none of {}{}", name, fmt::join(names, ", "),
                                               did_you_mean(name, names)));
    }
    word->apply(contents);
    known = known || word->says_what_is_kept;
  }
  if (!known)
    throw Error(ExitCode::Usage, fmt::format("--outputs {}: say which layers of the input are kept, beauty, layers or "
                                             "input: --outputs input{}{}",
                                             list, list.empty() ? "" : ",", list));
  return contents;
}

}  // namespace polyrecon
