#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "features/prepare.h"
#include "outliers/outlier.h"
#include "pipeline/phases.h"
#include "pipeline/survey.h"
#include "polyrecon/frame.h"
#include "polyrecon/params.h"
#include "temporal/geometry.h"

namespace polyrecon {

/// The use of the halves of a frame.
enum class HalvesFor {
  Fit,                ///< The frame is fitted by itself.
  FitWithNeighbours,  ///< The frame is fitted once its neighbours in time have joined it.
  Neighbour,          ///< The frame joins others as their neighbour in time: without features and noise bound.
};

/// A frame as two noisy halves without outliers, and what was found out about it on the way.
struct NoisyHalves {
  Survey survey;
  Geometry geometry;                           ///< Empty for HalvesFor::Fit.
  std::array<Image, surfaces> surfaces_noise;  ///< See surface_noise; for HalvesFor::FitWithNeighbours alone.
  Prepared prepared;
  std::vector<Outlier> outliers;
};

/// Runs the steps before the fit, in the one order that frames and their neighbours in time share. Takes features,
/// halves and variances out of the frame. stream: see Preparation::stream. Throws as survey_frame.
NoisyHalves make_noisy_halves(Frame& frame, HalvesFor purpose, std::uint64_t stream, const Params& params,
                              Phases& phases);

}  // namespace polyrecon
