#include "io/renderers/renderers.h"

// Each function has a file in this folder. To add a renderer, see docs/dev/add_a_renderer.md.
#define POLYRECON_RENDERERS(renderer)                                                                         \
  renderer(polyrecon_itself) renderer(any_renderer) renderer(blender) renderer(arnold) renderer(renderman)    \
      renderer(vray) renderer(corona) renderer(pbrt) renderer(mitsuba) renderer(tungsten) renderer(appleseed) \
          renderer(luxcore) renderer(povray) renderer(karma) renderer(redshift) renderer(octane) renderer(unreal)

namespace polyrecon {

#define POLYRECON_DECLARE(renderer) Renderer renderer();
#define POLYRECON_CALL(renderer) renderer(),

POLYRECON_RENDERERS(POLYRECON_DECLARE)

const std::vector<Renderer>& renderers() {
  static const std::vector<Renderer> all{POLYRECON_RENDERERS(POLYRECON_CALL)};
  return all;
}

}  // namespace polyrecon
