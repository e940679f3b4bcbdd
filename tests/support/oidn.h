#pragma once

#include <string>

#include "denoisers/oidn_library.h"
#include "polyrecon/error.h"

namespace polyrecon::test {

/// Why Open Image Denoise cannot be used here; empty where it can.
inline std::string oidn_problem() {
  try {
    const OidnLibrary library({});
    return "";
  } catch (const Error& error) {
    return error.what();
  }
}

}  // namespace polyrecon::test

/// Skips a test where Open Image Denoise is not installed.
#define SKIP_WITHOUT_OIDN() \
  if (const std::string problem = ::polyrecon::test::oidn_problem(); !problem.empty()) GTEST_SKIP() << problem
