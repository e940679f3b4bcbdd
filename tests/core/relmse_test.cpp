#include "core/relmse.h"

#include <gtest/gtest.h>

namespace polyrecon {
namespace {

TEST(RelativeSquaredError, IsRelativeToTheReferenceAboveTheFloor) {
  EXPECT_DOUBLE_EQ(relative_squared_error(2.0, 1.0), 1 / 1.01);
  EXPECT_DOUBLE_EQ(relative_squared_error(0.1, 0.0), 1.0);
  EXPECT_DOUBLE_EQ(relative_squared_error(-0.1, 0.0), 1.0);
  EXPECT_EQ(relative_squared_error(5.0, 5.0), 0);
}

}  // namespace
}  // namespace polyrecon
