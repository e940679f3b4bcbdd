#pragma once

#include <array>
#include <vector>

#include "core/image.h"
#include "features/half_pair.h"

namespace polyrecon {

/// One way to reconstruct the frame: what each half came to, made from data the other half's judgement does not share.
struct Candidate {
  std::array<Image, 2> half;  ///< As HalfPair::color.
  Image squared_bias;         ///< As the windows estimate it (5), 3 channels; empty if the candidate has none.
  Image variance;             ///< Of the windows, equation (6), 3 channels; empty if the candidate has none.
  Image order;                ///< Taylor order, 1 channel.
};

struct SelectParams {
  double risk_sigma = 3;   ///< Gaussian over which cross-validated errors are averaged, pixels.
  double map_sigma = 1.5;  ///< Gaussian by which the choice itself is smoothed.
};

/// Pixels around a region that select looks at.
int select_halo(const SelectParams& params);

/// Blends the candidates pixel by pixel by their cross-validated risk. With f_A, f_B the candidate's halves and A, B
/// the noisy ones,
///     risk = mean over RGB of [ ((f_A - B)^2 + (f_B - A)^2) / 2 - (f_A - f_B)^2 / 4 ] / (brightness^2 + epsilon)
/// is, but for the noise of A and B that all candidates share, an unbiased estimate of the relative squared error of
/// (f_A + f_B) / 2. Averaged over risk_sigma; a candidate's share is
///     exp(-z^2 / 2) / s,   z = D / SE,
/// with D its risk above the best's (the mean of several that are equally good: no rounding decides which the others
/// are compared with) and SE the standard error of D (how likely the difference is chance), and s the
/// standard deviation of its own noise, from the windows' variance averaged alike: of candidates that cannot be told
/// apart by their risk the less noisy ones count for more. Candidates without a variance have s = 1. Shares are
/// smoothed by map_sigma. brightness: 3 channels, a guess of the result. All images of one size; at least one
/// candidate.
Candidate select(const HalfPair& pair, const Image& brightness, const std::vector<Candidate>& candidates,
                 const SelectParams& params);

/// Beauty of the mean of a candidate's halves, 3 channels.
Image mean_of_halves(const Candidate& candidate);

/// The best of own and further images made from it, of which only the halves are given; bias, variance and order are
/// those of own. Without variances: they would be own's for all.
Candidate select_correction(const HalfPair& pair, Candidate own, std::vector<Candidate> corrected,
                            const SelectParams& params);

}  // namespace polyrecon
