#pragma once

#include <string>

#include "io/merge/task.h"

namespace polyrecon {

/// Whether the first two renders both have the first sample of a sequence.
enum class FirstSamples { Shared, Apart, Unknown };

/// Compares the depth of that sample, in the lines in the middle of the picture. A render of later samples of the
/// sequence has sky there.
FirstSamples compare_first_samples(const MergeTask& task, const std::string& view_layer);

/// Notes that the errors of short renders with different seeds are not independent where their first sample has the
/// same place: in the report and in the task. samples: of all renders.
void note_shared_samples(MergeTask& task, const std::string& view_layer, double samples, FirstSamples first_samples,
                         MergeResult& report);

}  // namespace polyrecon
