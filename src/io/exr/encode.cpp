#include "io/exr/encode.h"

#include <OpenEXR/ImfCompression.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <utility>

#include "core/parallel.h"

namespace polyrecon {
namespace {

/// Whether DWA takes a channel for a colour, by the last word of its name, whatever the layer is: the rules of OpenEXR,
/// which know capital letters only.
bool is_color_to_dwa(const std::string& channel) {
  static constexpr std::array colors{"R", "G", "B", "Y", "RY", "BY"};
  const std::string word = channel.substr(channel.rfind('.') + 1);
  return std::find(colors.begin(), colors.end(), word) != colors.end();
}

bool changes(Imf::Compression compression, Imf::PixelType type, const std::string& channel) {
  switch (compression) {
    case Imf::PXR24_COMPRESSION:
      return type == Imf::FLOAT;
    case Imf::B44_COMPRESSION:
    case Imf::B44A_COMPRESSION:
      return type == Imf::HALF;
    case Imf::DWAA_COMPRESSION:
    case Imf::DWAB_COMPRESSION:
      return type != Imf::UINT && is_color_to_dwa(channel);
    default:
      return false;
  }
}

/// Calls each(sample) for the samples of a channel of half or float, and stores what it returns.
template <typename Each>
void for_samples(NativeChannel& channel, const Each& each) {
  const auto run = [&](auto sample) {
    for (std::size_t at = 0; at + sizeof sample <= channel.samples.size(); at += sizeof sample) {
      std::memcpy(&sample, channel.samples.data() + at, sizeof sample);
      sample = static_cast<decltype(sample)>(each(static_cast<float>(sample)));
      std::memcpy(channel.samples.data() + at, &sample, sizeof sample);
    }
  };
  channel.type == Imf::HALF ? run(half()) : run(0.0F);
}

std::size_t not_finite(NativeChannel& channel) {
  std::size_t count = 0;
  for_samples(channel, [&](float sample) {
    count += std::isfinite(sample) ? 0 : 1;
    return sample;
  });
  return count;
}

/// Whether errors of the compression may lead beyond the range of half floats, which it stores.
bool stores_halves(Imf::Compression compression) { return compression != Imf::PXR24_COMPRESSION; }

}  // namespace

std::set<std::string> changed_channels(const Imf::Header& header) {
  std::set<std::string> changed;
  for (auto c = header.channels().begin(); c != header.channels().end(); ++c)
    if (changes(header.compression(), c.channel().type, c.name())) changed.insert(c.name());
  return changed;
}

std::string encode(Imf::Header& header, const Encoding& encoding, const std::set<std::string>& exact) {
  if (encoding.compression) header.compression() = static_cast<Imf::Compression>(*encoding.compression);
  header.zipCompressionLevel() = zip_level;
  header.dwaCompressionLevel() = static_cast<float>(encoding.dwa_level);
  for (const std::string& channel : changed_channels(header))
    if (exact.count(channel) > 0) {
      header.compression() = Imf::ZIP_COMPRESSION;
      return channel;
    }
  return {};
}

BandCheck::BandCheck(const Imf::Header& header)
    : changed_(changed_channels(header)), has_range_(stores_halves(header.compression())) {}

std::size_t BandCheck::keep_in_range(NativeBand& band) const {
  if (!has_range_) return 0;
  std::vector<std::size_t> counts(band.channels.size(), 0);
  in_parallel(counts.size(), [&](std::size_t c) {
    if (changed_.count(band.channels[c].name) == 0) return;
    for_samples(band.channels[c], [&](float sample) {
      if (!std::isfinite(sample) || std::abs(sample) <= largest_changed_sample) return sample;
      ++counts[c];
      return std::copysign(largest_changed_sample, sample);
    });
  });
  std::size_t all = 0;
  for (const std::size_t count : counts) all += count;
  return all;
}

void BandCheck::remember(NativeBand& band) {
  const std::vector<std::size_t> figures = figures_of(band);
  figures_.insert(figures_.end(), figures.begin(), figures.end());
}

const NativeChannel* BandCheck::first_mismatch(NativeBand& band) {
  const std::vector<std::size_t> found = figures_of(band);
  for (std::size_t c = 0; c < found.size(); ++c) {
    if (compared_ == figures_.size()) return &band.channels[c];
    const std::size_t expected = figures_[compared_++];
    const bool changed = changed_.count(band.channels[c].name) > 0;
    if (changed ? found[c] > expected : found[c] != expected) return &band.channels[c];
  }
  return nullptr;
}

std::vector<std::size_t> BandCheck::figures_of(NativeBand& band) const {
  std::vector<std::size_t> figures = hashes_of(band);
  in_parallel(figures.size(), [&](std::size_t c) {
    if (changed_.count(band.channels[c].name) > 0) figures[c] = not_finite(band.channels[c]);
  });
  return figures;
}

}  // namespace polyrecon
