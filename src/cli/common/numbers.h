#pragma once

#include <CLI/CLI.hpp>
#include <cmath>
#include <string>

namespace polyrecon {

/// Accepts finite numbers above 0.
inline CLI::Validator above_zero() {
  return {[](std::string& text) {
            double value = 0;
            const bool fits = CLI::detail::lexical_cast(text, value) && std::isfinite(value) && value > 0;
            return fits ? std::string() : text + " is no number above 0";
          },
          ""};
}

}  // namespace polyrecon
