#pragma once

#include <string>

#include "polyrecon/error.h"

namespace polyrecon {

/// The error about an input that does not exist. A wildcard arrives here where it was quoted or fits no file.
inline Error missing_file(const std::string& path) {
  const bool wildcard = path.find_first_of("*?") != std::string::npos;
  return {ExitCode::Missing,
          path + ": no such file" +
              (wildcard ? "; name a sequence as shot.####.exr, or the folder for all renders in it" : "")};
}

}  // namespace polyrecon
