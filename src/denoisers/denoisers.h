#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <string>

#include "core/color_layout.h"
#include "denoisers/oidn_library.h"
#include "polyrecon/denoiser.h"

namespace polyrecon {

/// Options of the command line about denoisers.
struct DenoiserOptions {
  OidnOptions oidn;

  bool is_default() const { return oidn.path.empty() && oidn.device == OidnOptions().device; }
};

/// A run of a denoiser takes at least these image channels and bytes in addition to its arguments and its result. Open
/// Image Denoise holds copies of colour, albedo, normal and output, and a fifth image while one is copied. Its code and
/// weights take 350 MB for 1920 x 1080 and more (version 2.5).
constexpr std::size_t denoiser_run_channels = std::size_t{4 + 1} * ColorLayout::primaries;
constexpr std::size_t least_denoiser_bytes = std::size_t{384} << 20;

using MakeDenoiser = std::unique_ptr<Denoiser> (*)(const DenoiserOptions& options);

/// The denoisers that --prior takes by name. Making one throws Error{Missing} where what it needs is not installed.
const std::map<std::string, MakeDenoiser>& denoisers();

/// Open Image Denoise, a network for renders.
std::unique_ptr<Denoiser> make_oidn(const DenoiserOptions& options);

}  // namespace polyrecon
