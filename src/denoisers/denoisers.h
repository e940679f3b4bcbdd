#pragma once

#include <map>
#include <memory>
#include <string>

#include "denoisers/oidn_library.h"
#include "polyrecon/denoiser.h"

namespace polyrecon {

/// Options of the command line about denoisers.
struct DenoiserOptions {
  OidnOptions oidn;

  bool is_default() const { return oidn.path.empty() && oidn.device == OidnOptions().device; }
};

using MakeDenoiser = std::unique_ptr<Denoiser> (*)(const DenoiserOptions& options);

/// The denoisers that --prior takes by name. Making one throws Error{Missing} where what it needs is not installed.
const std::map<std::string, MakeDenoiser>& denoisers();

/// Open Image Denoise, a network for renders.
std::unique_ptr<Denoiser> make_oidn(const DenoiserOptions& options);

}  // namespace polyrecon
