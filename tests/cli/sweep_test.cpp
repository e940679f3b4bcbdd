#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>

#include "cli/program.h"

namespace polyrecon::testing {
namespace {

class SweepCommand : public ProgramTest {
 protected:
  SweepCommand() {
    write_render(path("in.exr"));
    write_exr(path("ref.exr"), 40, 24, {"R", "G", "B"},
              [](int x, int y, int) { return (x < 20 ? 0.2 : 0.8) * (0.5 + y / 24.0); });
  }
  Outcome sweep(const std::vector<std::string>& more) const {
    std::vector<std::string> arguments{"sweep", "-i", "in.exr", "--reference", "ref.exr", "-o", "page.html"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run(arguments);
  }
  std::vector<std::vector<std::string>> rows(const std::string& name) const {
    std::vector<std::vector<std::string>> out;
    std::istringstream text(read_text(path(name)));
    for (std::string line; std::getline(text, line);) {
      std::vector<std::string> fields(1);
      bool quoted = false;
      for (const char c : line) {
        if (c == '"')
          quoted = !quoted;
        else if (c == ',' && !quoted)
          fields.emplace_back();
        else
          fields.back() += c;
      }
      out.push_back(fields);
    }
    return out;
  }
};

TEST_F(SweepCommand, WritesAPageAndTheFigures) {
  const Outcome done = sweep({"--csv", "f.csv", "--vary", "stages,order,features", "--also", "them, <b>=ref.exr:1.5"});
  ASSERT_EQ(done.code, 0) << done.err;
  const auto table = rows("f.csv");
  ASSERT_GT(table.size(), 8u);
  for (const auto& row : table) EXPECT_EQ(row.size(), table[0].size()) << row[3];
  const auto column = [&](const char* name) {
    return static_cast<std::size_t>(std::find(table[0].begin(), table[0].end(), name) - table[0].begin());
  };
  double noisy = 0, standard = 0;
  for (const auto& row : table) {
    if (row[3] == "noisy") noisy = std::stod(row[column("relMSE")]);
    if (row[3] == "standard") standard = std::stod(row[column("relMSE")]);
  }
  EXPECT_GT(noisy, standard);
  EXPECT_GT(standard, 0);
  EXPECT_EQ(table.back()[3], "them, <b>");  // the peer is the reference itself: no error, and no place in the plot
  EXPECT_EQ(std::stod(table.back()[column("relMSE")]), 0);
  const std::string page = read_text(path("page.html"));
  for (const auto& row : table) {
    if (row[2] != "stages" && row[2] != "features") continue;
    EXPECT_NE(page.find(">" + row[3] + "</text>"), std::string::npos) << row[3];
  }
  EXPECT_EQ(page.find("<b>="), std::string::npos);
  EXPECT_EQ(page.find("them, <b>"), std::string::npos);
  EXPECT_NE(page.find("them, &lt;b&gt;"), std::string::npos);
  for (const char* outside : {"http:", "https:", "<script src", "<link", "@import"})
    EXPECT_EQ(page.find(outside), std::string::npos) << outside;
}

TEST_F(SweepCommand, RefusesWhatCannotBe) {
  const std::vector<std::vector<std::string>> wrong{
      {"--also", "name"},        {"--also", "=ref.exr:1"},   {"--also", "a=ref.exr"}, {"--also", "a=ref.exr:x"},
      {"--also", "a=ref.exr:0"}, {"--also", "a=ref.exr:1s"}, {"--vary", "weather"},   {"--csv", "page.html"},
      {"--csv", "ref.exr"},      {"--threads", "-1"}};
  for (const auto& options : wrong) {
    const Outcome done = sweep(options);
    EXPECT_EQ(done.code, 2) << options[1];
    EXPECT_TRUE(is_one_error_line(done.err)) << options[1];
  }
  EXPECT_EQ(sweep({"--also", "a=gone.exr:1"}).code, 4);
  write_exr(path("small.exr"), 8, 8, {"R", "G", "B"}, [](int, int, int) { return 1.0; });
  const Outcome other_size = sweep({"--also", "a=small.exr:1"});
  EXPECT_EQ(other_size.code, 3);
  EXPECT_NE(other_size.err.find("8 x 8"), std::string::npos) << other_size.err;
  EXPECT_FALSE(exists("page.html"));
}

}  // namespace
}  // namespace polyrecon::testing
