#include "io/renderers/renderers.h"

namespace polyrecon {

/// The AOVs that Arnold's denoiser noice takes: denoise_albedo or diffuse_albedo, N and Z. Arnold's plug-ins add
/// "_noice" to the name of an AOV that the file has with another filter, too.
Renderer arnold() {
  Renderer r;
  r.name = "Arnold";
  r.versions = "AOVs for noice";
  r.passes = {
      {"RGBA", Role::Beauty, 2},
      {"denoise_albedo", Role::Albedo, 1},
      {"diffuse_albedo", Role::Albedo, 3},
      {"albedo", Role::Albedo, 2},
      {"N_noice", Role::Normal, 1},
      {"N", Role::Normal, 3},
      {"Z_noice", Role::Depth, 1},
      {"Z", Role::Depth, 2},
      {"AO", Role::Visibility, 3},
      {"P", Role::Other, 1},
      {"motionvector", Role::Other, 1},
      {"denoise_albedo_noice", Role::Albedo, 1},
      {"denoise_albedo_noisy", Role::Albedo, 2},
      {"diffuse_albedo_noice", Role::Albedo, 2},
  };
  r.beauty_companions = {{"variance", Companion::VarianceOfMean}};
  r.switches = {
      {Role::Albedo, "AOV denoise_albedo (Output Denoising AOVs)"},
      {Role::Normal, "AOV N (Output Denoising AOVs)"},
      {Role::Depth, "AOV Z (Output Denoising AOVs)"},
  };
  r.noise_switch = "Output Denoising AOVs writes the variance";
  return r;
}

}  // namespace polyrecon
