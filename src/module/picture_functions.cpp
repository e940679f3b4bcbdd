#include "module/picture_functions.h"

namespace polyrecon {

const PictureFunctions polyrecon_picture_functions{
    false_color, flip_color, describe_plain_image, read_plain_image, compose, stack, has_font, encode_picture,
};

}  // namespace polyrecon
