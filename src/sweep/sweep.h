#pragma once

#include <string>
#include <vector>

#include "polyrecon/frame.h"
#include "polyrecon/progress.h"
#include "sweep/trial.h"

namespace polyrecon {

/// A noisy render to reconstruct by many settings.
struct SweepInput {
  std::string name;    ///< File name.
  double samples = 0;  ///< Samples per pixel; 0: unknown.
  Frame frame;
};

/// Another program's result on the first input.
struct Peer {
  std::string name;
  double seconds = 0;  ///< As the user measured them.
  Image beauty;        ///< 3 channels.
  Score score;         ///< Filled by run_sweep.
};

/// A noisy render and its reconstructions.
struct SweptInput {
  std::string name;
  double samples = 0;
  Score noisy;
  Image beauty;               ///< The noisy one, 3 channels.
  std::vector<Trial> trials;  ///< The first is Quality::Standard.
};

/// The results of a sweep.
struct Sweep {
  std::vector<SweptInput>
      inputs;  ///< In the order given. The first one was tried with all settings, the others with the qualities.
  std::vector<Peer> peers;
  std::string reference_name;
  Reference reference;
  int threads = 0;
};

/// Tries all settings of the groups on the first input and the qualities on the others, and scores the peers. The units
/// of progress are settings. Throws as reconstruct and score do.
Sweep run_sweep(const std::vector<SweepInput>& inputs, const std::vector<std::string>& groups,
                const Reference& reference, std::vector<Peer> peers, Progress& progress);

/// A CSV line for each trial, noisy input and peer: input, samples, group, setting, runs, seconds, relMSE, trimmed,
/// energy, estimated relMSE, seconds of each phase. Names are quoted as in RFC 4180.
std::string csv_of(const Sweep& sweep);

}  // namespace polyrecon
