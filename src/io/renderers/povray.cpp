#include "io/renderers/renderers.h"

namespace polyrecon {

/// POV-Ray writes no passes; these are made by the driver in pipelines/povray/, which takes Blender's names.
Renderer povray() {
  Renderer r;
  r.name = "POV-Ray";
  r.versions = "as its driver writes";
  r.passes = {
      {"Combined", Role::Beauty, 2},          {"RGB", Role::Beauty, 2},
      {"Denoising Albedo", Role::Albedo, 1},  {"Denoising Normal", Role::Normal, 1},
      {"Denoising Depth", Role::Depth, 1},    {"Visibility", Role::Visibility, 1},
      {"Sample Count", Role::SampleCount, 1},
  };
  r.switches = {
      {Role::Albedo, "polyrecon-povray-passes renders it"},
      {Role::Normal, "polyrecon-povray-passes renders it"},
      {Role::Depth, "polyrecon-povray-passes renders it"},
  };
  r.noise_switch = "polyrecon-povray-passes renders several estimates of each pixel";
  return r;
}

}  // namespace polyrecon
