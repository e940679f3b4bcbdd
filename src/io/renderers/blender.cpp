#include "io/renderers/renderers.h"

namespace polyrecon {

Renderer blender() {
  Renderer r;
  r.name = "Blender";
  r.versions = "2.8 and later";
  r.passes = {
      {"Noisy Image", Role::Beauty, 1},
      {"Combined", Role::Beauty, 2},
      {"Image", Role::Beauty, 3},    // the File Output node's default
      {"Denoised", Role::Prior, 1},  // a name that people give in the compositor
      {"Denoising Albedo", Role::Albedo, 1},
      {"DiffCol", Role::Albedo, 4},
      {"Diffuse Color", Role::Albedo, 4},  // Blender 5
      {"Denoising Normal", Role::Normal, 1},
      {"Normal", Role::Normal, 3},
      {"Denoising Depth", Role::Depth, 1},
      {"Depth", Role::Depth, 2},
      {"Shadow", Role::Visibility, 2},             // Blender 2.8 to 4
      {"Ambient Occlusion", Role::Visibility, 3},  // Blender 5
      {"AO", Role::Visibility, 3},
      {"Denoising Specular Albedo", Role::SpecularAlbedo, 1},  // Blender 5.2
      {"Denoising Roughness", Role::Roughness, 1},             // Blender 5.2
      {"Debug Sample Count", Role::SampleCount, 2},
      {"Vector", Role::Motion, 1},
  };
  r.data_prefixes = {"index", "debug"};
  r.noisy_beauty = "Noisy Image";
  r.samples_attributes = {{"cycles.{}.samples", true}};
  r.sample_fraction = "Debug Sample Count";
  r.render_time = "Render Time";
  r.divided_passes = {"DiffDir",
                      "DiffInd",
                      "Diffuse Direct",
                      "Diffuse Indirect",
                      "GlossDir",
                      "GlossInd",
                      "TransDir",
                      "TransInd",
                      "Glossy Direct",
                      "Glossy Indirect",
                      "Transmission Direct",
                      "Transmission Indirect"};
  r.surface_colors = {"GlossCol", "TransCol", "Glossy Color", "Transmission Color"};
  r.compositing_depth = "Depth";
  r.first_sample_is_central = true;
  r.sky_depth = 1e10;  // from 5.2 on the largest float
  // Vector holds (X, Y) from here to the place in the frame before and (Z, W) from the place in the frame after to
  // here, with rows counted upwards.
  r.motion_factors = {1, -1, -1, 1};
  r.many_layers = "OpenEXR MultiLayer";
  r.switches = {
      {Role::Albedo, "View Layer > Passes > Data > Denoising Data"},
      {Role::Normal, "View Layer > Passes > Data > Denoising Data"},
      {Role::Depth, "View Layer > Passes > Data > Denoising Data"},
  };
  r.noise_switch = "polyrecon-blender-passes, or merge renders of different seeds";
  return r;
}

}  // namespace polyrecon
