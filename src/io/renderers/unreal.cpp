#include "io/renderers/renderers.h"

namespace polyrecon {

/// Unreal Engine's Movie Render Queue: layers are called after the render pass and the material that made them.
Renderer unreal() {
  Renderer r;
  r.name = "Unreal Engine";
  r.versions = "Movie Render Queue";
  r.passes = {{"RGBA", Role::Beauty, 2}, {"PathTracer", Role::Beauty, 3}, {"FinalImage", Role::Beauty, 3}};
  for (const std::string pass : {"FinalImage", "PathTracer"}) {
    r.passes.push_back({pass + "BaseColor", Role::Albedo, 3});
    r.passes.push_back({pass + "WorldNormal", Role::Normal, 3});
    r.passes.push_back({pass + "MovieRenderQueue_WorldNormal", Role::Normal, 3});
    r.passes.push_back({pass + "MovieRenderQueue_WorldDepth", Role::Depth, 2});
    r.passes.push_back({pass + "SceneDepthWorldUnits", Role::Depth, 2});
    r.passes.push_back({pass + "SceneDepth", Role::Depth, 3});
    r.passes.push_back({pass + "MovieRenderQueue_MotionVectors", Role::Other, 1});
  }
  r.data_prefixes = {"actorhitproxymask"};  // Cryptomatte
  return r;
}

}  // namespace polyrecon
