#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>

namespace polyrecon::test {

inline std::string text_of(const std::string& path) {
  std::ifstream in(path);
  EXPECT_TRUE(in) << path;
  std::stringstream text;
  text << in.rdbuf();
  return text.str();
}

/// The part of text between two marks. An empty `end` means the end of the text.
inline std::string between(const std::string& text, const std::string& begin, const std::string& end) {
  const std::size_t at = text.find(begin);
  if (at == std::string::npos) return {};
  const std::size_t first = at + begin.size();
  return text.substr(first, end.empty() ? std::string::npos : text.find(end, first) - first);
}

/// Expects `text` between two marks of a file. With POLYRECON_UPDATE in the environment it is written there instead;
/// `git diff` then shows what changed.
inline void expect_recorded(const std::string& path, const std::string& begin, const std::string& end,
                            const std::string& text) {
  const std::string all = text_of(path), recorded = between(all, begin, end);
  const std::size_t at = all.find(begin);
  ASSERT_NE(at, std::string::npos) << path << " has no " << begin;
  if (recorded != text && std::getenv("POLYRECON_UPDATE") != nullptr) {
    const std::size_t first = at + begin.size();
    std::ofstream(path) << all.substr(0, first) << text << all.substr(first + recorded.size());
    return;
  }
  EXPECT_EQ(recorded, text) << path << ": if the change is meant, run this test with POLYRECON_UPDATE=1";
}

}  // namespace polyrecon::test
