#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>

#include "cli/program.h"

namespace polyrecon::testing {
namespace {

using nlohmann::json;

class SettingsChosen : public ProgramTest {
 protected:
  json report_of(const std::vector<std::string>& options) {
    write_render(path("in.exr"));
    std::vector<std::string> arguments{"denoise", "-i", "in.exr", "-o", "out.exr", "--overwrite", "--report", "r.json"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    const Outcome done = run(arguments);
    EXPECT_EQ(done.code, 0) << done.err;
    out_ = done.out;
    return json::parse(read_text(path("r.json")));
  }
  std::string out_;
};

TEST_F(SettingsChosen, WithoutARequestNothingIsChosen) { EXPECT_TRUE(report_of({})["settings_choice"].is_null()); }

TEST_F(SettingsChosen, AGenerousBudgetTakesTheMostAccurateSettings) {
  const json choice = report_of({"--time-budget", "1000"})["settings_choice"];
  EXPECT_TRUE(choice["met"]);
  EXPECT_TRUE(choice["next"].is_null());
  EXPECT_GT(choice["actual_seconds"], 0);
}

TEST_F(SettingsChosen, ABudgetThatCannotBeKeptTakesTheFastestAndSaysSo) {
  const json choice = report_of({"--time-budget", "0.000001"})["settings_choice"];
  EXPECT_FALSE(choice["met"]);
  EXPECT_NE(out_.find("cannot be met"), std::string::npos) << out_;
  EXPECT_FALSE(choice["next"].is_null());
  EXPECT_GT(choice["next"]["seconds"], choice["chosen"]["seconds"]);
  EXPECT_LT(choice["next"]["relmse"], choice["chosen"]["relmse"]);
  EXPECT_NE(out_.find("the next more accurate settings"), std::string::npos) << out_;
}

TEST_F(SettingsChosen, AnErrorThatIsEasyToReachTakesTheFastest) {
  const json easy = report_of({"--target", "10"})["settings_choice"];
  EXPECT_TRUE(easy["met"]);
  const json hard = report_of({"--target", "1e-9"})["settings_choice"];
  EXPECT_FALSE(hard["met"]);
  EXPECT_TRUE(hard["next"].is_null());
  EXPECT_GT(hard["chosen"]["seconds"], easy["chosen"]["seconds"]);
}

TEST_F(SettingsChosen, WithASampleMapATargetIsTheMapsAlone) {
  EXPECT_TRUE(report_of({"--sample-map", "s.exr", "--target", "0.1"})["settings_choice"].is_null());
}

/// A crash of the renderer left three of the frame's four blocks without a finite pixel.
TEST_F(SettingsChosen, ARequestAndInspectTakeWhatDenoiseTakes) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  write_exr(path("in.exr"), 128, 128, {"R", "G", "B"},
            [&](int x, int y, int c) { return x >= 64 || y >= 64 ? nan : 1 + 0.01 * ((x * 7 + y * 13 + c) % 11); });
  for (const std::vector<std::string>& more :
       {std::vector<std::string>{}, {"--time-budget", "100"}, {"--target", "0.1"}}) {
    std::vector<std::string> arguments{"denoise",     "-i", "in.exr",    "-o",   "out.exr",
                                       "--overwrite", "-v", "--quality", "draft"};
    if (!more.empty()) arguments.resize(7);
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Outcome done = run(arguments);
    EXPECT_EQ(done.code, 0) << done.err;
    EXPECT_NE(done.out.find("12288 repaired"), std::string::npos) << done.out;
  }
  const Outcome inspected = run({"inspect", "in.exr"});
  EXPECT_EQ(inspected.code, 0) << inspected.err;
  EXPECT_NE(inspected.out.find("12288 NaN"), std::string::npos) << inspected.out;
}

TEST_F(SettingsChosen, InspectSaysThatNoPixelIsFinite) {
  write_exr(path("in.exr"), 8, 8, {"R", "G", "B"},
            [](int, int, int) { return std::numeric_limits<double>::quiet_NaN(); });
  const Outcome inspected = run({"inspect", "in.exr"});
  EXPECT_EQ(inspected.code, 0) << inspected.err;
  EXPECT_NE(inspected.out.find("note: layer 'RGBA': no pixel is finite and at most 1e15; render the frame again"),
            std::string::npos)
      << inspected.out;
  EXPECT_EQ(run({"denoise", "-i", "in.exr", "-o", "out.exr"}).code, 6);
}

TEST_F(SettingsChosen, StepsRunAsRequested) {
  const auto decision = [](const json& report, const std::string& step) {
    for (const json& d : report["decisions"])
      if (d["step"] == step) return d;
    return json();
  };
  const json only = report_of({"--steps", "albedo,fireflies"});
  EXPECT_TRUE(decision(only, "feature albedo")["run"]);
  EXPECT_FALSE(decision(only, "feature depth")["run"]);
  EXPECT_EQ(decision(only, "feature depth")["reason"], "not requested");
  EXPECT_NE(only["settings"].get<std::string>().find("--stages 1"), std::string::npos) << only["settings"];
  const json all = report_of({"--steps", "all"});
  EXPECT_TRUE(decision(all, "feature depth")["run"]);
  EXPECT_FALSE(decision(all, "noise-free pixels skipped")["run"]);
  EXPECT_EQ(decision(report_of({"--steps", "depth"}), "firefly removal")["reason"], "not requested");
}

}  // namespace
}  // namespace polyrecon::testing
