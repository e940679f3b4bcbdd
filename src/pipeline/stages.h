#pragma once

#include <chrono>
#include <cstddef>
#include <string>

#include "polyrecon/progress.h"
#include "polyrecon/report.h"

namespace polyrecon {

/// Runs the stages of the pipeline, announces each to progress, and notes in the report how long it took.
class Stages {
 public:
  Stages(Progress& progress, Report& report) : progress_(progress), report_(report) {}

  /// Runs a stage and returns its result. stage: a function of a Progress, to which it reports `steps` steps in all.
  template <typename Stage>
  auto run(const std::string& name, std::size_t steps, const Stage& stage) {
    const auto start = std::chrono::steady_clock::now();
    progress_.begin(name, steps);
    auto result = stage(progress_);
    progress_.end();
    report_.stages.push_back({name, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count()});
    return result;
  }

 private:
  Progress& progress_;
  Report& report_;
};

}  // namespace polyrecon
