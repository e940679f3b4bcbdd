#pragma once

namespace polyrecon {

constexpr double pi = 3.14159265358979323846;

}  // namespace polyrecon
