#include "io/renderers/renderers.h"

namespace polyrecon {

/// The G-buffer film of pbrt-v4.
Renderer pbrt() {
  Renderer r;
  r.name = "pbrt";
  r.versions = "version 4";
  r.passes = {
      {"RGB", Role::Beauty, 2}, {"RGBA", Role::Beauty, 2}, {"Albedo", Role::Albedo, 2},
      {"Ns", Role::Normal, 2},  {"N", Role::Normal, 3},    {"RelativeVariance", Role::Other, 1},
      {"P", Role::Other, 1},
  };
  r.beauty_companions = {{"Variance", Companion::VarianceOfSample}};
  r.samples_attributes = {{"samplesPerPixel"}};
  return r;
}

}  // namespace polyrecon
