#pragma once

#include "polyrecon/error.h"

namespace polyrecon {

/// The exception that is being handled, a std::exception, as the Error that the program reports. Call it inside a catch
/// block.
Error current_error();

}  // namespace polyrecon
