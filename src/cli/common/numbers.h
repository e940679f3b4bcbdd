#pragma once

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <string>

namespace polyrecon {

/// Accepts finite numbers above 0. CLI11's own checks compare, and every comparison with NaN is false.
inline CLI::Validator above_zero() {
  return {[](std::string& text) {
            double value = 0;
            const bool fits = CLI::detail::lexical_cast(text, value) && std::isfinite(value) && value > 0;
            return fits ? std::string() : text + " is no number above 0";
          },
          ""};
}

/// Accepts finite numbers from `least` to `most`.
inline CLI::Validator from_to(double least, double most) {
  return {[least, most](std::string& text) {
            double value = 0;
            const bool fits = CLI::detail::lexical_cast(text, value) && value >= least && value <= most;
            return fits ? std::string() : fmt::format("{} is no number from {} to {}", text, least, most);
          },
          ""};
}

/// Accepts finite numbers that are not negative.
inline CLI::Validator zero_or_more() {
  return {[](std::string& text) {
            double value = 0;
            const bool fits = CLI::detail::lexical_cast(text, value) && std::isfinite(value) && value >= 0;
            return fits ? std::string() : text + " is no number of 0 or more";
          },
          ""};
}

}  // namespace polyrecon
