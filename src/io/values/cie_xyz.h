#pragma once

#include <array>
#include <cstddef>

namespace polyrecon {

using Triple = std::array<double, 3>;

// Linear RGB with the primaries and the white of sRGB (ITU-R BT.709, D65) to CIE XYZ, and back.
constexpr std::array<Triple, 3> rgb_to_xyz{
    {{0.412453, 0.357580, 0.180423}, {0.212671, 0.715160, 0.072169}, {0.019334, 0.119193, 0.950227}}};
constexpr std::array<Triple, 3> xyz_to_rgb{
    {{3.240479, -1.537150, -0.498535}, {-0.969256, 1.875991, 0.041556}, {0.055648, -0.204043, 1.057311}}};

inline Triple product(const std::array<Triple, 3>& matrix, const Triple& v) {
  Triple out{};
  for (std::size_t i = 0; i < 3; ++i) out[i] = matrix[i][0] * v[0] + matrix[i][1] * v[1] + matrix[i][2] * v[2];
  return out;
}

}  // namespace polyrecon
