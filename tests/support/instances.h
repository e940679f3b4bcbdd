#pragma once

#include <cstdlib>

namespace polyrecon::test {

/// Number of random instances to try: in_a_long_run if POLYRECON_LONG_TESTS is in the environment
/// (docs/dev/testing.md), else usual.
inline int instances(int usual, int in_a_long_run) {
  return std::getenv("POLYRECON_LONG_TESTS") ? in_a_long_run : usual;
}

}  // namespace polyrecon::test
