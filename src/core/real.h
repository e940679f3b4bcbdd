#pragma once

namespace polyrecon {

/// Type of stored samples, chosen when the project is configured (POLYRECON_REAL). Sums are always double.
using Real = POLYRECON_REAL;

}  // namespace polyrecon
