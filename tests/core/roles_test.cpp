#include "polyrecon/roles.h"

#include <gtest/gtest.h>

#include <set>
#include <string>

#include "polyrecon/read_options.h"
#include "regression/basis.h"

namespace polyrecon {
namespace {

TEST(Roles, NamesAreFoundAgain) {
  std::set<std::string> names;
  for (const RoleInfo& info : role_table()) {
    EXPECT_EQ(role_from(info.name), info.role) << info.name;
    EXPECT_STREQ(name_of(info.role), info.name);
    EXPECT_TRUE(names.insert(info.name).second) << info.name;
    if (!info.chosen) continue;
    const RoleMapping mapping = parse_mapping(std::string(info.name) + "=x");
    EXPECT_TRUE(mapping.role == info.role && mapping.companion == Companion::Mean) << info.name;
  }
  EXPECT_FALSE(role_from("Beauty"));
  EXPECT_FALSE(role_from(""));
}

TEST(Roles, FeaturesAreReadWholeAndTheModelHoldsThemAll) {
  int channels = 0;
  for (const RoleInfo& info : role_table()) {
    EXPECT_EQ(feature_roles().has(info.role), info.feature) << info.name;
    if (!info.feature) {
      EXPECT_FALSE(info.noise_is_estimated) << info.name;
      continue;
    }
    EXPECT_TRUE(info.chosen && info.in_fit && info.expected && !info.on_request) << info.name;
    EXPECT_TRUE(info.layer_channels.allow(static_cast<std::size_t>(info.channels))) << info.name;
    channels += info.channels;
  }
  EXPECT_GE(channels, 8);
  EXPECT_LE(channels, BasisLayout::max_features);
}

TEST(Roles, ChannelCountsAllowWhatIsListed) {
  const ChannelCounts some{1, 3};
  EXPECT_TRUE(some.allow(1) && some.allow(3));
  EXPECT_FALSE(some.allow(0) || some.allow(2) || some.allow(33));
  EXPECT_TRUE(ChannelCounts::any().allow(0) && ChannelCounts::any().allow(1000));
}

TEST(Roles, NoiseIsEstimatedWhereItIsNeitherKnownNorTheDepths) {
  EXPECT_TRUE(noise_is_estimated(Role::Normal, false));
  EXPECT_FALSE(noise_is_estimated(Role::Normal, true));
  EXPECT_FALSE(noise_is_estimated(Role::Depth, false));
  EXPECT_FALSE(noise_is_estimated(Role::Beauty, false));  // noise_variance() sees to the beauty
}

TEST(Roles, SetsHoldWhatIsInserted) {
  RoleSet roles = feature_roles();
  roles.erase(Role::Normal);
  roles.insert(Role::Motion);
  EXPECT_FALSE(roles.has(Role::Normal) || roles.has(Role::Beauty));
  EXPECT_TRUE(roles.has(Role::Albedo) && roles.has(Role::Motion));
  roles.clear();
  EXPECT_FALSE(roles.has(Role::Albedo));
}

}  // namespace
}  // namespace polyrecon
