#pragma once

#include <cstdlib>

namespace polyrecon::test {

/// How many instances of a family to try: more with POLYRECON_LONG_TESTS=1 in the environment
/// (docs/results/reliability.md).
inline int instances(int usual, int in_a_long_run) {
  return std::getenv("POLYRECON_LONG_TESTS") ? in_a_long_run : usual;
}

}  // namespace polyrecon::test
