#include "core/frame_shape.h"

namespace polyrecon {

void add_pass(FrameShape& shape, Role role, const PassImages& images) {
  const RoleInfo& info = info_of(role);
  if (role == Role::Color) shape.color_channels += info.channels;
  if (info.feature) shape.feature_channels += info.channels;
  if (noise_is_estimated(role, images.variance || images.halves)) shape.channels += info.channels;
  if (role == Role::Prior) {
    shape.prior_channels += images.count() * info.channels;
    shape.prior_has_halves = images.halves;
  }
}

}  // namespace polyrecon
