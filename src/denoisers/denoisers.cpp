#include "denoisers/denoisers.h"

namespace polyrecon {

const std::map<std::string, MakeDenoiser>& denoisers() {
  static const std::map<std::string, MakeDenoiser> all{
      {"oidn", make_oidn},
  };
  return all;
}

}  // namespace polyrecon
