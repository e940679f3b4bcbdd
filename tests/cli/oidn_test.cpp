#include "support/oidn.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

#include "cli/program.h"

namespace polyrecon::testing {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

class OidnPrior : public ProgramTest {};

TEST_F(OidnPrior, IsMadeAndReported) {
  SKIP_WITHOUT_OIDN();
  write_render(path("in.exr"));
  const Outcome done = run({"denoise", "-i", "in.exr", "-o", "out.exr", "--prior", "oidn", "--quality", "draft",
                            "--report", "report.json", "--error-map", "error.exr", "--quiet"});
  ASSERT_EQ(done.code, 0) << done.err;
  const OIIO::ImageBuf map = load(path("error.exr"));
  const int channel = map.spec().channelindex("priorshare.Y");
  ASSERT_GE(channel, 0);
  double sum = 0;
  for (int y = 0; y < map.spec().height; ++y)
    for (int x = 0; x < map.spec().width; ++x) {
      const float share = map.getchannel(x, y, 0, channel);
      ASSERT_TRUE(share >= 0 && share <= 1) << share;
      sum += static_cast<double>(share);
    }
  EXPECT_GT(sum / (map.spec().width * map.spec().height), 0.05);
  const auto report = nlohmann::json::parse(read_text(path("report.json")));
  EXPECT_THAT(report["settings"].get<std::string>(), HasSubstr("prior=oidn"));
  const auto& decisions = report["decisions"];
  const auto prior =
      std::find_if(decisions.begin(), decisions.end(), [](const auto& d) { return d["step"] == "prior"; });
  ASSERT_NE(prior, decisions.end());
  EXPECT_THAT((*prior)["reason"].get<std::string>(), AllOf(HasSubstr("Open Image Denoise 2."), HasSubstr("%")));
  EXPECT_LT(std::abs(report["energy"]["relative_change"].get<double>()), 0.002);
}

TEST_F(OidnPrior, ThatIsNotInstalledEndsBeforeAnythingIsRead) {
  write_render(path("in.exr"));
  const Outcome done = run({"denoise", "-i", "in.exr", "-o", "out.exr", "--prior", "oidn", "--oidn", "nowhere.so"});
  EXPECT_EQ(done.code, 4);
  EXPECT_TRUE(is_one_error_line(done.err));
  EXPECT_THAT(done.err, AllOf(HasSubstr("--oidn"), HasSubstr("nowhere.so")));
  EXPECT_FALSE(exists("out.exr"));
}

TEST_F(OidnPrior, CountsInABudgetOfTime) {
  SKIP_WITHOUT_OIDN();
  write_render(path("in.exr"));
  const auto choice_with = [&](const std::vector<std::string>& options) {
    std::vector<std::string> arguments{"denoise",  "-i",          "in.exr",      "-o",      "out.exr",
                                       "--report", "report.json", "--overwrite", "--quiet", "--time-budget"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    const Outcome done = run(arguments);
    EXPECT_EQ(done.code, 0) << done.err;
    return nlohmann::json::parse(read_text(path("report.json")))["settings_choice"];
  };
  const auto generous = choice_with({"1000", "--prior", "oidn"});
  EXPECT_TRUE(generous["met"]);
  EXPECT_TRUE(generous["next"].is_null());
  EXPECT_GT(generous["chosen"]["seconds"], choice_with({"1000"})["chosen"]["seconds"]);
  EXPECT_FALSE(choice_with({"0.000001", "--prior", "oidn"})["met"]);
}

TEST_F(OidnPrior, NeedsMemory) {
  SKIP_WITHOUT_OIDN();
  write_render(path("in.exr"), 640, 480);
  const Outcome done = run({"denoise", "-i", "in.exr", "-o", "out.exr", "--prior", "oidn", "--max-memory", "300M"});
  EXPECT_EQ(done.code, 33) << done.err;
  EXPECT_THAT(done.err, HasSubstr("needs --max-memory"));
}

TEST_F(OidnPrior, IsForetoldByInspect) {
  write_render(path("in.exr"));
  const Outcome without = run({"inspect", "in.exr", "--oidn", "nowhere.so", "--json"});
  ASSERT_EQ(without.code, 0) << without.err;
  const auto missing = nlohmann::json::parse(without.out)["denoisers"][0];
  EXPECT_EQ(missing["name"], "");
  EXPECT_THAT(missing["problem"].get<std::string>(), HasSubstr("nowhere.so"));
  SKIP_WITHOUT_OIDN();
  const auto found = nlohmann::json::parse(run({"inspect", "in.exr", "--json"}).out)["denoisers"][0];
  EXPECT_EQ(found["prior"], "oidn");
  EXPECT_THAT(found["name"].get<std::string>(), HasSubstr("Open Image Denoise 2."));
  EXPECT_THAT(found["place"].get<std::string>(), HasSubstr("OpenImageDenoise"));
}

}  // namespace
}  // namespace polyrecon::testing
