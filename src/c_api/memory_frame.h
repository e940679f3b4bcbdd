#pragma once

#include <map>
#include <string>
#include <vector>

#include "c_api/memory_image.h"
#include "polyrecon/frame.h"

namespace polyrecon {

/// The place in a frame of an image of the filter "denoise", by name: "albedo", "albedo variance", "aov Diffuse A".
struct ImagePlace {
  enum class Part { Mean, Variance, HalfA, HalfB };

  Role role = Role::Beauty;
  std::string aov;  ///< The name of a further layer; empty for other roles.
  Part part = Part::Mean;
};

/// Throws Error{Usage} for a name that no image of a frame has.
ImagePlace place_of(const std::string& name);

/// The names of all images that place_of takes, but for further layers.
std::vector<std::string> frame_image_names();

/// The images of a frame with their names.
std::vector<NamedImage> named_images(const Frame& frame);

/// Makes a frame of images in memory. samples: per pixel, 0 if unknown. Values are treated as those of files are
/// (read_frame): half samples of +Inf, sample counts, halves that contradict their mean; each case adds a line to
/// `notes`. Throws Error{Usage} where images do not fit together or there is no beauty.
Frame frame_from_memory(const std::map<std::string, MemoryImage>& images, double samples,
                        std::vector<std::string>& notes);

}  // namespace polyrecon
