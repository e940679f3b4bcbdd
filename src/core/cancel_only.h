#pragma once

#include "polyrecon/progress.h"

namespace polyrecon {

/// Forwards cancellation of an outer computation but none of the work, for a step whose units are not those of it.
class CancelOnly final : public Progress {
 public:
  explicit CancelOnly(const Progress& outer) : outer_(outer) {}
  bool cancelled() const override { return outer_.cancelled(); }

 private:
  const Progress& outer_;
};

}  // namespace polyrecon
