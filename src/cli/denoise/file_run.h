#pragma once

#include <cstddef>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "cli/common/progress_output.h"
#include "cli/denoise/job.h"
#include "cli/denoise/load_frame.h"
#include "cli/denoise/report.h"
#include "polyrecon/reconstruct.h"

namespace polyrecon {

/// A picture of a file that was denoised.
struct DonePicture {
  ReadResult in;  ///< Without the images that are not written.
  Result result;
  RunReport report;
  std::string identity, neighbours_identity;  ///< Those of the LoadedFrame.
};

/// Denoises the pictures of one file, one after the other, and writes them together: one for each view layer and view
/// with a beauty, and one for each layer of --aov that is no part of the beauty and gets windows of its own. The
/// results wait in memory, the inputs do not.
class FileRun {
 public:
  /// The job and the files must outlive the run.
  FileRun(const Job& job, const FrameFiles& files) : job_(job), files_(files) {}

  /// Lists which other pictures of the file are to be denoised, and takes the layers that are no part of the beauty out
  /// of the frame. Call it with each picture as it was loaded, before denoise.
  void list_others(LoadedFrame& loaded);

  /// The picture to load after those that were listed; nothing when there is none left.
  std::optional<PictureChoice> next();

  /// Reconstructs a picture within max_memory bytes, less what the results of earlier pictures take. Prints what
  /// was read unless the job is quiet. Throws as reconstruct does.
  void denoise(LoadedFrame loaded, std::size_t max_memory, RunProgress& progress);

  /// Writes the file of all pictures, their maps and the report, and prints the report unless the job is quiet. Returns
  /// whether the time budget or the target was missed, which it prints in any case. Throws as write_result does.
  bool write(RunProgress& progress);

 private:
  void add(PictureChoice picture);
  /// The limits for the next picture: its share of what the pictures before left.
  FrameLimits limits_left() const;
  /// The limits that the file missed, for people; empty where it kept them.
  std::vector<std::string> missed_limits() const;
  void release_images(DonePicture& done) const;

  const Job& job_;
  const FrameFiles& files_;
  std::size_t count_ = 0;  ///< Pictures of the file, as far as is known.
  std::deque<PictureChoice> left_;
  std::vector<DonePicture> done_;
  double spent_ = 0;  ///< Seconds for the pictures before, of --time-budget.
};

}  // namespace polyrecon
