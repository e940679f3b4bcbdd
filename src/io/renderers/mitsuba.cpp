#include "io/renderers/renderers.h"

namespace polyrecon {

/// The integrators aov and moment of Mitsuba 3.
Renderer mitsuba() {
  Renderer r;
  r.name = "Mitsuba";
  r.versions = "version 3";
  r.passes = {
      {"RGBA", Role::Beauty, 2},      {"RGB", Role::Beauty, 2}, {"albedo", Role::Albedo, 2},
      {"sh_normal", Role::Normal, 2}, {"nn", Role::Normal, 2},  {"geo_normal", Role::Normal, 4},
      {"depth", Role::Depth, 2},
  };
  r.letters = {{"T", Role::Depth, 3}};
  r.affixes = {{"m2_", Companion::SecondMoment, CompanionAffix::Place::BeforeWord}};
  r.beauty_moment_is_nested = true;  // the moment integrator keeps it with the nested one
  r.switches = {
      {Role::Albedo, "aovs \"albedo:albedo\" of the aov integrator"},
      {Role::Normal, "aovs \"nn:sh_normal\" of the aov integrator"},
      {Role::Depth, "aovs \"dd:depth\" of the aov integrator"},
  };
  r.noise_switch = "put the integrator into a moment integrator";
  return r;
}

}  // namespace polyrecon
