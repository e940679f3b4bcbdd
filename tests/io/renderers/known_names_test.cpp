#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>
#include <vector>

#include "io/layers/channel_names.h"
#include "support/recorded.h"

namespace polyrecon {
namespace {

/// One layer of known_names.txt: `file | layer | channels | role | rank | holds | of`. Lines with the same number
/// belong to one file. The channels are single letters; "#" in front of them makes them uint.
struct Line {
  std::string file, layer, channels;

  std::string channel(char letter) const { return layer.empty() ? std::string(1, letter) : layer + "." + letter; }
};

std::vector<Line> read_lines(std::istream& in) {
  std::vector<Line> lines;
  for (std::string text; std::getline(in, text);) {
    if (text.empty() || text.front() == '#') continue;
    std::vector<std::string> cells;
    for (std::size_t begin = 0; cells.size() < 3;) {
      const std::size_t end = std::min(text.find(" | ", begin), text.size());
      cells.push_back(text.substr(begin, end - begin));
      begin = std::min(end + 3, text.size());
    }
    lines.push_back({cells[0], cells[1], cells[2]});
  }
  return lines;
}

FileInfo file_of(const std::vector<Line>& lines, const std::string& file) {
  FileInfo info;
  info.parts.emplace_back();
  for (const Line& line : lines) {
    if (line.file != file) continue;
    const bool uint = line.channels.front() == '#';
    for (const char letter : line.channels.substr(uint ? 1 : 0))
      info.parts.front().channels.push_back({line.channel(letter), uint ? SampleType::Uint : SampleType::Float});
  }
  return info;
}

std::string described(const std::vector<Layer>& layers, const Line& line) {
  const std::string first = line.channel(line.channels[line.channels.front() == '#' ? 1 : 0]);
  for (const Layer& layer : layers)
    if (std::find(layer.channels.begin(), layer.channels.end(), first) != layer.channels.end())
      return fmt::format("{} | {} | {} | {} | {} | {} | {}\n", line.file, line.layer, line.channels,
                         name_of(layer.role), layer.rank, name_of(layer.companion), layer.of.empty() ? "-" : layer.of);
  return fmt::format("{} | {} | {} | no layer has the channel {}\n", line.file, line.layer, line.channels, first);
}

/// Every name that a renderer uses, files of each renderer, and names that look like one of these: what the program
/// takes each layer for.
TEST(KnownNames, AreClassifiedAsListed) {
  const std::string path = POLYRECON_SOURCE_DIR "/tests/io/renderers/known_names.txt";
  std::istringstream listed(test::text_of(path));
  const std::vector<Line> lines = read_lines(listed);
  ASSERT_GT(lines.size(), 500u);
  std::string found;
  for (const Line& line : lines) found += described(find_layers(file_of(lines, line.file)), line);
  test::expect_recorded(
      path, "# file | layer | channels (single letters; # in front of them: uint) | role | rank | holds | of\n", "",
      found);
}

}  // namespace
}  // namespace polyrecon
