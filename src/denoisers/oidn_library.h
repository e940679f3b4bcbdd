#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "polyrecon/image.h"

namespace polyrecon {

/// Which library is loaded, and what runs it.
struct OidnOptions {
  std::string path;             ///< The library or a folder with it; empty: $POLYRECON_OIDN, else oidn_places().
  std::string device = "auto";  ///< auto, cpu, cuda, hip, sycl or metal.
};

/// The devices that OidnOptions takes.
std::vector<std::string> oidn_devices();

/// Files that may be the library, in the order in which they are tried: that of the system, Blender's (the program on
/// the PATH, and the module bpy), and the wheel pyoidn. All but the first exist.
std::vector<std::string> oidn_places();

/// Whether the library's file is there, in `path`, $POLYRECON_OIDN, oidn_places() or a folder of the system's
/// libraries. It is not loaded.
bool oidn_is_installed(const std::string& path = "");

/// Images of one run, of 3 channels and one size; null where there is none. Albedo and normal of a colour have no
/// noise.
struct OidnImages {
  const Image* color = nullptr;
  const Image* albedo = nullptr;
  const Image* normal = nullptr;

  const Image& shape() const { return color ? *color : albedo ? *albedo : *normal; }
};

/// Open Image Denoise (version 2 of its C interface), loaded while the program runs, with a device that is ready.
class OidnLibrary {
 public:
  /// Loads the library. Throws Error{Missing} where there is none, or where it has no such device.
  explicit OidnLibrary(const OidnOptions& options);
  ~OidnLibrary();
  OidnLibrary(const OidnLibrary&) = delete;
  OidnLibrary& operator=(const OidnLibrary&) = delete;

  std::string path() const;
  std::string version() const;  ///< "2.5.1"
  std::string device() const;   ///< "cpu"

  /// Denoises the colour by the filter for ray tracing; without a colour, the albedo or the normal alone.
  /// max_bytes: working memory of the library, which takes tiles if it needs more, and exceeds it if
  /// even the smallest tile needs more.
  /// advance: is called with the share of the work that was done since the last call, and returns whether to go on.
  /// Throws Error{Interrupted} where it said no.
  Image filter(const OidnImages& images, std::size_t max_bytes, const std::function<bool(double)>& advance) const;

 private:
  struct Loaded;
  std::unique_ptr<Loaded> loaded_;
};

}  // namespace polyrecon
