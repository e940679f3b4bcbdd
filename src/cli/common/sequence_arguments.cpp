#include "cli/common/sequence_arguments.h"

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <utility>

#include "polyrecon/error.h"

namespace polyrecon {

std::vector<SequenceArgument> sequence_arguments(const std::vector<std::string>& texts) {
  std::vector<SequenceArgument> arguments;
  for (const std::string& text : texts) arguments.push_back({text, FramePattern::parse(text)});
  return arguments;
}

std::vector<int> common_frames(const std::vector<SequenceArgument>& arguments, const std::string& wanted) {
  std::optional<std::vector<int>> frames;
  for (const SequenceArgument& argument : arguments) {
    if (!argument.pattern) continue;
    const std::vector<int> existing = argument.pattern->existing_frames();
    if (!frames) {
      frames = existing;
      continue;
    }
    std::vector<int> common;
    std::set_intersection(frames->begin(), frames->end(), existing.begin(), existing.end(), std::back_inserter(common));
    frames = std::move(common);
  }
  if (!frames) {
    if (!wanted.empty()) throw Error(ExitCode::Usage, "--frames needs a name of a sequence, such as clean.####.exr");
    return {};
  }
  if (!wanted.empty()) return parse_frames(wanted);
  if (frames->empty()) throw Error(ExitCode::Missing, "the sequences have no frame in common");
  return *frames;
}

std::vector<std::string> short_names(const std::vector<std::string>& paths) {
  std::vector<std::string> names;
  for (const std::string& text : paths) {
    const std::filesystem::path path(text);
    std::filesystem::path name = path.filename(), rest = path.parent_path();
    const auto shared = [&] {
      const std::string ending = "/" + name.string();
      return std::any_of(paths.begin(), paths.end(), [&](const std::string& other) {
        const std::string whole = "/" + other;
        return other != text && whole.size() >= ending.size() &&
               whole.compare(whole.size() - ending.size(), ending.size(), ending) == 0;
      });
    };
    while (shared() && rest.has_filename()) {
      name = rest.filename() / name;
      rest = rest.parent_path();
    }
    names.push_back(name.string());
  }
  return names;
}

}  // namespace polyrecon
