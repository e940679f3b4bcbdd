#pragma once

#include <cstddef>
#include <string_view>

namespace polyrecon {

/// What a stage tells of its progress. Stages call it from any thread; an implementation must be thread-safe.
/// The base class is silent and never cancels.
class Progress {
 public:
  virtual ~Progress() = default;
  /// A stage begins that will report `steps` steps in all.
  virtual void begin(std::string_view stage, std::size_t steps);
  virtual void advance(std::size_t steps);
  /// The current stage is over.
  virtual void end();
  /// True once the work should stop; throws nothing itself.
  virtual bool cancelled() const;
};

}  // namespace polyrecon
