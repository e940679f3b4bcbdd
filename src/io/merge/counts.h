#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "io/merge/task.h"

namespace polyrecon {

/// Finds which view layers have known sample counts, and the numbers in the metadata. Reports what is doubtful.
void find_counts(MergeTask& task, MergeResult& report);

/// The sample counts n_k of the pixels of an area in one render; 0 where there are none.
std::vector<double> read_counts(const MergeTask& task, const Render& render, const std::string& view_layer,
                                const Rect& area);

/// Mean samples per pixel of some renders, from a few lines of their sample-count pass; all the same if unknown.
std::vector<double> mean_samples(const MergeTask& task, const std::vector<std::size_t>& renders);

/// Weight of each pixel of an area: [render][view layer][pixel].
using Weights = std::vector<std::map<std::string, std::vector<double>>>;

/// The sample counts of all renders; where they are unknown, the weights of regions. No weight: all count alike.
Weights read_weights(const MergeTask& task, const Rect& area);

}  // namespace polyrecon
