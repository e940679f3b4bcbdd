#pragma once

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfHeader.h>

#include <cstddef>
#include <set>
#include <string>
#include <vector>

#include "io/exr/bands.h"
#include "polyrecon/encoding.h"

namespace polyrecon {

/// The channels of a part whose samples its compression may change, by their types and names.
std::set<std::string> changed_channels(const Imf::Header& header);

/// Sets compression and level of a part. Where the compression would change one of the channels `exact`, the part gets
/// ZIP; returns that channel, else an empty text.
std::string encode(Imf::Header& header, const Encoding& encoding, const std::set<std::string>& exact);

/// Remembers the samples of each band before a part is written, to compare them with those that are read back. It keeps
/// a hash of each channel, or if the compression may change the channel, the number of samples that are not finite.
class BandCheck {
 public:
  explicit BandCheck(const Imf::Header& header);

  /// Limits the samples of channels that may change to largest_changed_sample, since the errors of the compression
  /// would lead beyond the range of half floats. Returns the number of samples that were limited.
  std::size_t keep_in_range(NativeBand& band) const;

  /// To be called for each band in the order of writing.
  void remember(NativeBand& band);

  /// The first channel whose samples are not those that were remembered; nullptr where all are. To be called for each
  /// band in the same order.
  const NativeChannel* first_mismatch(NativeBand& band);

 private:
  std::vector<std::size_t> figures_of(NativeBand& band) const;

  std::set<std::string> changed_;
  bool has_range_;                    ///< The compression stores half floats.
  std::vector<std::size_t> figures_;  ///< For each band and channel.
  std::size_t compared_ = 0;
};

/// Largest sample of a channel that a compression may change, so that none becomes infinite.
constexpr float largest_changed_sample = 32752;

}  // namespace polyrecon
