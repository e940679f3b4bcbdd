#pragma once

#include <cstddef>
#include <string>

#include "core/stopwatch.h"
#include "polyrecon/progress.h"
#include "polyrecon/report.h"

namespace polyrecon {

/// Runs the phases of the pipeline, announces each to progress, and notes in the report how long it took.
class Phases {
 public:
  Phases(Progress& progress, Report& report) : progress_(progress), report_(report) {}

  /// Runs a phase and returns its result. phase: a function of a Progress, to which it reports `units` units of work
  /// in all.
  template <typename Phase>
  auto run(const std::string& name, std::size_t units, const Phase& phase) {
    const Stopwatch watch;
    progress_.begin(name, units);
    auto result = phase(progress_);
    progress_.end();
    report_.phases.push_back({name, watch.seconds()});
    return result;
  }

 private:
  Progress& progress_;
  Report& report_;
};

}  // namespace polyrecon
