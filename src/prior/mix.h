#pragma once

#include <array>
#include <cstddef>

#include "core/candidate.h"
#include "core/color_layout.h"
#include "core/half_pair.h"
#include "polyrecon/image.h"

namespace polyrecon {

/// Two pictures of each half of the samples, which the other half can validate because they are made without it. 3
/// channels.
struct ValidationHalves {
  std::array<Image, 2> prior;  ///< The half, denoised by the other denoiser.
  std::array<Image, 2> ours;   ///< The half, reconstructed alone.
};

/// Share of the reconstruction in its mix with a prior, 1 channel, 0..1.
///
/// With P_h, D_h the pictures of half h, and y_o the samples of the other half, mu = P + w (D - P) + error is fitted by
/// least squares: the noise of y_o is independent of P_h and D_h, so that
///     w = sum (y_o - P_h) (D_h - P_h) s / sum (D_h - P_h)^2 s
/// estimates the w of least squared error against the true image. Sums are over both halves, the colours, and Gaussians
/// of 6, 12 and 24 pixels, whose three w are averaged. Each is regularised towards the w of the whole frame where (D -
/// P)^2 is less than on average. s = 1 / (P_h^2 + epsilon) / (v + mean(v) / 10 + 0.003), with v the smoothed relative
/// (y_o - P_h)^2, lets noisy pixels weigh less. pair: the samples, the first 3 channels of color.
///
/// s depends on y_o, so w is drawn to a dark prior where noise comes in spikes: there most samples are below the truth,
/// and the few far above it weigh little. A fair w' has weights that are made without y_o,
///     s' = 1 / (P_h^2 + D_h^2 + epsilon) / (v' + mean(v') / 10 + 0.003),   v' from (y_h - D_h)^2 / (D_h^2 + epsilon),
/// and is less certain. Where it differs from w by more than its standard error, the rest of the difference is added to
/// w: for the whole frame, and then in each Gaussian.
Image reconstruction_share(const HalfPair& pair, const ValidationHalves& halves);

/// Channels that reconstruction_share or unvalidated_share holds in addition to its arguments.
constexpr std::size_t share_channels =
    5 /* terms */ + 2 * ColorLayout::primaries /* weights, or differences of two pictures */ + 1 /* share */;

/// The same where nothing validates the prior, since the halves were split from one picture and their noise may have
/// been estimated wrong: a quarter, less what the reconstruction f has kept of the noise y - P,
///     w = (1 - b) / 4,   b = sum k(y - P) k(f - P) s / sum k(y - P)^2 s, within 0..1.
/// k is the product of [1 -3 3 -1] along x and along y, which passes the corner of the spectrum only: white noise is
/// there, and hardly anything of the picture. Sums are Gaussians of 6 pixels. y: the mean of the pair.
/// prior, reconstruction: 3 channels.
Image unvalidated_share(const HalfPair& pair, const Image& prior, const Image& reconstruction);

/// prior + share (reconstruction - prior) for the beauty of both halves; the rest stays as it is.
Candidate mix_with_prior(Candidate reconstruction, const Image& prior, const Image& share);

/// Brings layers to a new beauty, so that colour layers which added up to the old one add up to the new one: each is
/// multiplied by new / old, within 1/4 to 4, and what this leaves is distributed by their magnitudes.
/// layers: beauty and colour layers (core/color_layout.h). beauty: the new one in its first 3 channels.
Image follow_beauty(Image layers, const Image& beauty);

}  // namespace polyrecon
