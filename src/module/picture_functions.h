#pragma once

#include "io/files/plain_image_file.h"
#include "io/pictures/false_color.h"
#include "io/pictures/preview.h"

namespace polyrecon {

/// The functions that need libOpenImageIO. The program gets them from a module that it loads at the first call.
struct PictureFunctions {
  decltype(&polyrecon::false_color) false_color;
  decltype(&polyrecon::flip_color) flip_color;
  decltype(&polyrecon::describe_plain_image) describe_plain_image;
  decltype(&polyrecon::read_plain_image) read_plain_image;
  decltype(&polyrecon::compose) compose;
  decltype(&polyrecon::stack) stack;
  decltype(&polyrecon::has_font) has_font;
  decltype(&polyrecon::encode_picture) encode_picture;
};

/// The symbol that the program looks up in the module.
extern "C" const PictureFunctions polyrecon_picture_functions;

}  // namespace polyrecon
