#include "io/renderers/renderers.h"

// To add a renderer: a file in this folder with a function that returns its Renderer, the function's name in this list,
// a test, and the row that tests/io/renderers_test.cpp prints for docs/reference/formats.md.
#define POLYRECON_RENDERERS(renderer)                                                                          \
  renderer(polyrecon_itself) renderer(any_renderer) renderer(blender) renderer(arnold) renderer(renderman)     \
      renderer(vray) renderer(pbrt) renderer(mitsuba) renderer(tungsten) renderer(appleseed) renderer(luxcore) \
          renderer(povray)

namespace polyrecon {

#define POLYRECON_DECLARE(renderer) Renderer renderer();
#define POLYRECON_CALL(renderer) renderer(),

POLYRECON_RENDERERS(POLYRECON_DECLARE)

const std::vector<Renderer>& renderers() {
  static const std::vector<Renderer> all{POLYRECON_RENDERERS(POLYRECON_CALL)};
  return all;
}

}  // namespace polyrecon
