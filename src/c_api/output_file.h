#pragma once

#include <string>
#include <vector>

#include "c_api/memory_image.h"
#include "maps/error_map_images.h"
#include "polyrecon/read_frame.h"
#include "polyrecon/reconstruct.h"
#include "polyrecon/write_result.h"

// Results of the C interface: the images that a filter gives out, and files.
namespace polyrecon {

/// The images of a result with their names: "result", "aov NAME", "alpha" if it was reconstructed, "order", and those
/// of error_map_images without the channel. Takes them out of the result.
std::vector<NamedImage> result_images(const Frame& frame, Result result, bool with_alpha);

/// The name of an image of an error map: that of its channels in a file, without "." and what follows.
std::string error_image_name(const ErrorMapImage& entry);

/// Throws Error{Usage} unless the name of an output ends in .exr, and Error{CannotWrite} where it cannot be written.
void require_exr_output(const std::string& path);

/// Name, length and checksum of the files of a frame.
std::string identity_of_input(const FrameSource& source);

/// New samples of the picture (Role::Beauty), of its alpha or of another layer (Role::Color).
struct NewLayer {
  Role role = Role::Beauty;
  std::string name;  ///< The layer's, for Role::Color.
  Image image;
};

/// Writes a copy of the file that `in` was read from, with these layers in it. Returns notes. Throws as write_result,
/// and Error{Usage} where the file does not have such a layer, or not of this size.
std::vector<std::string> write_like(const ReadResult& in, const std::vector<NewLayer>& layers,
                                    const std::string& target, const WriteOptions& options);

}  // namespace polyrecon
