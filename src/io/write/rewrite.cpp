#include "io/write/rewrite.h"

#include <Iex.h>
#include <OpenEXR/ImfDeepScanLineInputPart.h>
#include <OpenEXR/ImfDeepScanLineOutputPart.h>
#include <OpenEXR/ImfDeepTiledInputPart.h>
#include <OpenEXR/ImfDeepTiledOutputPart.h>
#include <OpenEXR/ImfMultiPartInputFile.h>
#include <OpenEXR/ImfMultiPartOutputFile.h>
#include <OpenEXR/ImfOutputPart.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfThreading.h>
#include <OpenEXR/ImfTiledInputPart.h>
#include <OpenEXR/ImfTiledOutputPart.h>
#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "core/first_line.h"
#include "core/rect.h"
#include "io/exr/bands.h"
#include "io/exr/encode.h"
#include "io/exr/out_of_memory.h"
#include "io/exr/raw.h"
#include "io/exr/writable.h"
#include "io/files/atomic_file.h"
#include "io/files/file_identity.h"
#include "io/values/beyond_range.h"
#include "io/write/part_rewrite.h"
#include "io/write/store.h"
#include "polyrecon/error.h"

namespace polyrecon {
namespace {

/// Makes a band of the output from one of the input: copies the samples, moves replaced ones to their noisy names and
/// puts the new ones in their place.
void apply(const NewChannels& replaced, NativeBand& old, NativeBand& band, std::size_t& saturated) {
  for (NativeChannel& channel : band.channels)
    if (NativeChannel* same = old.find(channel.name)) channel.samples.swap(same->samples);
  const Rect lines{old.x0, old.y0, old.x0 + old.width, old.y1};
  for (const auto& [name, source] : replaced) {
    NativeChannel* channel = band.find(name);
    if (!old.find(name)) std::fill(channel->samples.begin(), channel->samples.end(), 0);
    if (!source.noisy_name.empty()) band.find(source.noisy_name)->samples = channel->samples;
    const Rect covered = intersect(lines, source.window);
    for (int y = covered.y0; y < covered.y1; ++y) {
      const std::size_t to = static_cast<std::size_t>(y - lines.y0) * static_cast<std::size_t>(old.width) +
                             static_cast<std::size_t>(covered.x0 - lines.x0);
      const std::size_t from = source.image->index(covered.x0 - source.window.x0, y - source.window.y0);
      for (std::size_t k = 0; k < static_cast<std::size_t>(covered.width()); ++k)
        store(*channel, to + k, source.at(from + k), saturated);
    }
  }
}

std::vector<Imf::Header> headers_of(const Imf::MultiPartInputFile& file) {
  std::vector<Imf::Header> headers;
  for (int p = 0; p < file.parts(); ++p) headers.push_back(file.header(p));
  return headers;
}

/// A file that is written again with changes. write() and verify() are the two steps of write_atomically.
class Rewrite {
 public:
  Rewrite(const FrameSource& source, const std::vector<Replacement>& replacements, const WriteOptions& options)
      : path_(source.path),
        input_(source.path.c_str(), Imf::globalThreadCount(), false),
        parts_(plan_parts(source, headers_of(input_), replacements, options, notes_)) {
    require_writable(path_, headers());
  }

  void write(const std::string& path) {
    const std::vector<Imf::Header> written = headers();
    saturated_ = shortened_ = 0;
    checks_.clear();
    Imf::MultiPartOutputFile output(path.c_str(), written.data(), static_cast<int>(written.size()), true);
    for (std::size_t p = 0; p < parts_.size(); ++p) {
      checks_.emplace_back(parts_[p].header);
      parts_[p].copied_raw ? copy_part(output, p) : write_changed(output, p);
    }
    if (saturated_ > 0)
      notes_.push_back(fmt::format("{} half samples were beyond {} and are written as that", saturated_, largest_half));
    if (shortened_ > 0)
      notes_.push_back(
          fmt::format("{} samples beyond {} are written as that, since the lossy compression could make "
                      "them infinite",
                      shortened_, largest_changed_sample));
  }

  void verify(const std::string& path) {
    input_.flushPartCache();  // copying opened tiled parts as tiled, and the cache would keep them so
    Imf::MultiPartInputFile written(path.c_str(), Imf::globalThreadCount(), false);
    for (std::size_t p = 0; p < parts_.size(); ++p) {
      const PartRewrite& part = parts_[p];
      const bool same =
          part.copied_raw ? same_chunks(path_, part.input, path, static_cast<int>(p)) : same_samples(written, p);
      if (!same)
        throw std::runtime_error(fmt::format("{} differs when it is read back", part_title(part.header, part.input)));
      if (part.copied_raw) decode(part);
    }
  }

  std::vector<std::string> take_notes() { return std::move(notes_); }

 private:
  std::vector<Imf::Header> headers() const {
    std::vector<Imf::Header> all;
    for (const PartRewrite& part : parts_) all.push_back(part.header);
    return all;
  }

  void copy_part(Imf::MultiPartOutputFile& output, std::size_t p) {
    const int from = parts_[p].input;
    try {
      copy_raw(output, from, static_cast<int>(p));
    } catch (const Iex::InputExc& problem) {
      throw_if_out_of_memory(problem);
      throw Error(ExitCode::BadInput, fmt::format("{}: incomplete or damaged: {} cannot be copied ({})", path_,
                                                  part_title(input_.header(from), from), first_line(problem.what())));
    }
  }

  void copy_raw(Imf::MultiPartOutputFile& output, int source, int target) {
    const std::string& type = input_.header(source).type();
    if (type == Imf::DEEPSCANLINE) {
      Imf::DeepScanLineInputPart from(input_, source);
      Imf::DeepScanLineOutputPart(output, target).copyPixels(from);
    } else if (type == Imf::DEEPTILE) {
      Imf::DeepTiledInputPart from(input_, source);
      Imf::DeepTiledOutputPart(output, target).copyPixels(from);
    } else if (type == Imf::TILEDIMAGE) {
      Imf::TiledInputPart from(input_, source);
      Imf::TiledOutputPart(output, target).copyPixels(from);
    } else {
      Imf::InputPart from(input_, source);
      Imf::OutputPart(output, target).copyPixels(from);
    }
  }

  /// Makes `band` of the output. `old` is a band of the input, whose memory is used.
  void make_band(Imf::InputPart& from, const PartRewrite& part, NativeBand& old, NativeBand& band,
                 std::size_t& saturated) {
    old.take_lines(band.y0, band.y1);
    try {
      read_band(from, old);
    } catch (const Iex::BaseExc& problem) {
      throw_if_out_of_memory(problem);
      throw Error(ExitCode::BadInput,
                  fmt::format("{}: incomplete or damaged: {} cannot be read at scanlines {} to {} ({})", path_,
                              part_title(input_.header(part.input), part.input), old.y0, old.y1 - 1,
                              first_line(problem.what())));
    }
    apply(part.replaced, old, band, saturated);
  }

  void write_changed(Imf::MultiPartOutputFile& output, std::size_t p) {
    const PartRewrite& part = parts_[p];
    Imf::InputPart from(input_, part.input);
    NativeBand old(input_.header(part.input));
    write_bands(output, static_cast<int>(p), [&](NativeBand& band) {
      make_band(from, part, old, band, saturated_);
      shortened_ += checks_[p].keep_in_range(band);
      checks_[p].remember(band);
    });
  }

  /// Decodes every band of the written part and compares it with what was written.
  bool same_samples(Imf::MultiPartInputFile& written, std::size_t p) {
    Imf::InputPart back(written, static_cast<int>(p));
    NativeBand found(back.header());
    for (const auto& [y0, y1] : bands_of(back.header())) {
      found.take_lines(y0, y1);
      read_band(back, found);
      if (checks_[p].first_mismatch(found)) return false;
    }
    return true;
  }

  /// Decodes a part that was copied chunk by chunk, so that damage in it is reported.
  void decode(const PartRewrite& part) {
    const Imf::Header& header = input_.header(part.input);
    if (!is_plain(header)) return;
    Imf::InputPart from(input_, part.input);
    std::size_t ignored = 0;
    NativeBand old(header), band(header);
    for (const auto& [y0, y1] : bands_of(header)) {
      band.take_lines(y0, y1);
      make_band(from, part, old, band, ignored);
    }
  }

  std::string path_;
  std::vector<std::string> notes_;
  Imf::MultiPartInputFile input_;
  std::vector<PartRewrite> parts_;
  std::size_t saturated_ = 0, shortened_ = 0;
  std::vector<BandCheck> checks_;  ///< For each part.
};

}  // namespace

std::vector<std::string> rewrite_file(const FrameSource& source, const std::vector<Replacement>& replacements,
                                      const std::string& target, const WriteOptions& options) {
  const FileInfo& input = source.files.front();  // it is read a second time
  require_unchanged(input);
  Rewrite rewrite(source, replacements, options);
  const auto verify = [&](const std::string& path) {
    rewrite.verify(path);
    require_unchanged(input);
  };
  write_atomically(
      target, [&](const std::string& path) { rewrite.write(path); }, verify);
  return rewrite.take_notes();
}

}  // namespace polyrecon
