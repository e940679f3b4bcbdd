#pragma once

#include "core/half_pair.h"

namespace polyrecon {

/// The correlation r of the noise of pixels next to each other in halves of independent samples: 0 unless a pixel
/// filter spreads samples over several pixels (splatting: 0.39 with Mitsuba's Gaussian, 0.25 with a tent). The
/// difference of the halves is noise alone. With s its signs,
///     r = sin(pi / 2 mean(s(x) s(x + 1))),
/// which holds for Gaussian noise of any variance, and which no firefly decides. Sums are over rows, columns and the
/// beauty's colours, without pixels in which the halves are equal or that are no samples of the picture. 0 below 0.15,
/// which is more than chance and box filters make.
double correlation_of_halves(const HalfPair& pair);

/// Whether two pictures were made of the two halves of a pair, each of its own one: they keep a little of its noise,
/// however well a denoiser works. With s, t the signs of the differences of the halves and of the pictures, the mean of
/// s t is above 0.02 then (0.07 to 0.5 for Open Image Denoise). It is 0 for pictures of something else and for two
/// equal ones, and below 0 for pictures that are swapped. True where fewer than 1000 values have noise, which tell
/// nothing. a, b: 3 channels, of the pair's size; values that are not finite count as equal.
bool made_of_halves(const HalfPair& pair, const Image& a, const Image& b);

}  // namespace polyrecon
