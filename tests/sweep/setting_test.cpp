#include "sweep/setting.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "presets/preset.h"
#include "support/scene.h"

namespace polyrecon {
namespace {

Frame frame_with_halves() {
  Frame frame = test::make_scene(32, 24, 0.1, 1).frame;
  frame.beauty.half_a = frame.beauty.half_b = frame.beauty.mean;
  frame.prior.mean = frame.beauty.mean;
  return frame;
}

bool has(const std::vector<Setting>& settings, const std::string& name) {
  return std::any_of(settings.begin(), settings.end(), [&](const Setting& s) { return s.name == name; });
}

TEST(Settings, StandardComesFirstAndNamesAreUniqueAndValid) {
  const auto settings = settings_for(frame_with_halves(), setting_groups());
  ASSERT_FALSE(settings.empty());
  EXPECT_EQ(settings.front().name, "standard");
  std::set<std::string> names;
  for (const Setting& setting : settings) {
    EXPECT_TRUE(names.insert(setting.name).second) << setting.name;
    EXPECT_NO_THROW(validate(setting.params)) << setting.name;
    const auto& groups = setting_groups();
    EXPECT_NE(std::find(groups.begin(), groups.end(), setting.group), groups.end()) << setting.group;
  }
  for (const Preset& preset : presets()) EXPECT_TRUE(names.count(preset.name)) << preset.name;
}

TEST(Settings, OnlyTheGroupsThatAreAskedFor) {
  const auto settings = settings_for(frame_with_halves(), {"stages", "prior"});
  for (const Setting& s : settings)
    EXPECT_TRUE(s.name == "standard" || s.group == "stages" || s.group == "prior") << s.name;
  EXPECT_TRUE(has(settings, "stages 1"));
  EXPECT_TRUE(has(settings, "without prior"));
}

TEST(Settings, WhatTheFrameLacksIsNotTakenOut) {
  Frame frame = frame_with_halves();
  frame.features.clear();
  frame.prior = {};
  frame.beauty.half_a = frame.beauty.half_b = Image();
  const auto settings = settings_for(frame, setting_groups());
  for (const char* name : {"without prior", "without half buffers", "without features", "without albedo"})
    EXPECT_FALSE(has(settings, name)) << name;
}

TEST(Settings, TheFrameIsWhatTheSettingWants) {
  const Frame frame = frame_with_halves();
  Setting setting{"x", "halves", params_for(Quality::Standard)};
  EXPECT_TRUE(frame_for(frame, setting).beauty.has_halves());
  setting.without_halves = setting.without_prior = true;
  const Frame without = frame_for(frame, setting);
  EXPECT_FALSE(without.beauty.has_halves());
  EXPECT_TRUE(without.prior.mean.empty());
  EXPECT_EQ(without.features.size(), frame.features.size());
}

}  // namespace
}  // namespace polyrecon
