#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "cli/denoise/denoise_frame.h"
#include "cli/denoise/denoise_options.h"
#include "cli/denoise/frame_files.h"

namespace polyrecon {

/// Reads frames one after the other, each with its neighbours in time; neighbours that two frames in succession share
/// are read once.
class FrameFetcher {
 public:
  FrameFetcher(const DenoiseOptions& options, std::function<bool()> cancelled)
      : options_(options), cancelled_(std::move(cancelled)) {}

  /// Reads a frame, or finds that it needs no work (--skip-existing): then there is nothing. A file that is not there,
  /// not complete or not readable yet is tried again until it was left unchanged for --wait seconds. A neighbour that
  /// cannot be had is left out, with a note where it is there but broken.
  /// Throws as read_frame does; Error{Interrupted} when cancelled() says so.
  std::optional<LoadedFrame> fetch(const FrameFiles& files);

 private:
  using Prepared = std::shared_ptr<const Neighbour>;
  std::optional<LoadedFrame> fetch_now(const FrameFiles& files);
  Prepared neighbour(const NeighbourFile& file, LoadedFrame& loaded);
  void add_neighbours(const FrameFiles& files, LoadedFrame& loaded);
  /// attempt(), again and again as long as the file at path may still become readable and `seconds` have not passed.
  template <typename Attempt>
  auto wait_for(const std::string& path, double seconds, const Attempt& attempt);

  const DenoiseOptions& options_;
  std::function<bool()> cancelled_;
  std::map<std::string, Prepared> prepared_;  ///< By path; those that the next frame may need.
};

}  // namespace polyrecon
