#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "cli/denoise/job.h"
#include "cli/denoise/load_frame.h"

namespace polyrecon {

/// Reads frames one after the other, each with its neighbours in time. A neighbour that two successive frames share is
/// read once.
class FrameFetcher {
 public:
  /// `job` must outlive the fetcher.
  FrameFetcher(const Job& job, std::function<bool()> cancelled) : job_(job), cancelled_(std::move(cancelled)) {}

  /// Reads the first picture of a frame; returns nothing where --skip-existing finds its outputs finished. A file that
  /// is missing, incomplete or unreadable is tried again until it has not changed for --wait seconds. A neighbour that
  /// cannot be read is left out; a note says so if its file exists. Throws as read_frame does; Error{Interrupted} once
  /// cancelled() is true.
  std::optional<LoadedFrame> fetch(const FrameFiles& files);

  /// Reads another picture of a frame that was fetched. Throws as fetch.
  LoadedFrame fetch(const FrameFiles& files, const PictureChoice& picture);

 private:
  LoadedFrame load_with_neighbours(const FrameFiles& files, const ReadOptions& options);
  /// Reads a neighbour, or takes it from those that are kept; its offset is not set.
  LoadedNeighbour neighbour(const NeighbourFile& file, LoadedFrame& loaded);
  void add_neighbours(const FrameFiles& files, LoadedFrame& loaded);
  /// Repeats attempt() while the file at path may become readable and has changed within the last `seconds`.
  template <typename Attempt>
  auto wait_for(const std::string& path, double seconds, const Attempt& attempt);

  const Job& job_;
  std::function<bool()> cancelled_;
  /// Neighbours by path and picture, kept for the next frame. A file of several pictures keeps those of one.
  std::map<std::string, LoadedNeighbour> prepared_;
};

}  // namespace polyrecon
