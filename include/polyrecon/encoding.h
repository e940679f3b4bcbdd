// How OpenEXR files are packed.
#pragma once

#include <optional>

namespace polyrecon {

/// The compressions of OpenEXR, with the numbers that files have for them. From Pxr24 on they may change samples.
enum class Compression { None, Rle, Zips, Zip, Piz, Pxr24, B44, B44a, Dwaa, Dwab };

/// OpenEXR's own level: errors are hard to see.
constexpr double default_dwa_level = 45;

/// How a file is packed. Channels that a compression may not change, such as ids and noise, keep their bits: a part
/// with one that it would change is written with ZIP.
struct Encoding {
  std::optional<Compression> compression;  ///< Unset: each function that takes it names its default.
  double dwa_level = default_dwa_level;    ///< For Dwaa and Dwab: higher makes smaller files and larger errors.
};

}  // namespace polyrecon
