#include "core/utf8.h"

#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

namespace polyrecon {
namespace {

TEST(Utf8, CharactersOfEveryLength) {
  const std::string text = "a\xc3\x9f\xe2\x82\xac\xf0\x9f\x98\x80";
  const std::vector<std::pair<char32_t, std::size_t>> expected{{'a', 1}, {0xdf, 2}, {0x20ac, 3}, {0x1f600, 4}};
  std::size_t at = 0;
  for (const auto& [code, bytes] : expected) {
    const CodePoint point = code_point_at(text, at);
    EXPECT_TRUE(point.valid);
    EXPECT_EQ(point.code, code);
    EXPECT_EQ(point.bytes, bytes);
    at += point.bytes;
  }
  EXPECT_EQ(at, text.size());
}

TEST(Utf8, OtherBytesStandForThemselves) {
  for (const std::string text :
       {"\xdf",
        "\xdf"
        "e",
        "\xc0\xaf", "\xe0\x80\xaf", "\xed\xa0\x80", "\xf4\x90\x80\x80", "\xff", "\x80", "\xe2\x82", "\xf0\x9f\x98"}) {
    const CodePoint point = code_point_at(text, 0);
    EXPECT_FALSE(point.valid) << text;
    EXPECT_EQ(point.bytes, 1U) << text;
    EXPECT_EQ(point.code, static_cast<unsigned char>(text[0])) << text;
  }
}

TEST(Utf8, ControlCharacters) {
  for (const char32_t code : {0x0U, 0x1bU, 0x7fU, 0x9bU, 0x61cU, 0x200fU, 0x2028U, 0x202eU, 0x2069U})
    EXPECT_TRUE(is_control(code)) << static_cast<unsigned>(code);
  for (const char32_t code : {0x20U, 0x7eU, 0xa0U, 0xdfU, 0x2010U, 0x20acU, 0x1f600U})
    EXPECT_FALSE(is_control(code)) << static_cast<unsigned>(code);
}

}  // namespace
}  // namespace polyrecon
