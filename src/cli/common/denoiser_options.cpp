#include "cli/common/denoiser_options.h"

namespace polyrecon {

void add_denoiser_options(OptionSet& set, DenoiserOptions& options) {
  set.add(Changes::Result, "--oidn", options.oidn.path,
          "Open Image Denoise: its library, or the folder of it; default: that of the system, of Blender or of the "
          "Python package pyoidn")
      ->type_name("PATH");
  set.add(Changes::Result, "--oidn-device", options.oidn.device,
          "What runs Open Image Denoise: auto (what it offers), cpu, cuda, hip, sycl or metal")
      ->check(one_of(oidn_devices()))
      ->default_str("auto")
      ->type_name("DEVICE");
}

}  // namespace polyrecon
