#pragma once

#include "io/layers/layer_choice.h"
#include "polyrecon/read_options.h"

namespace polyrecon {

/// Adds the layers that the user wants to be denoised with the beauty.
void choose_aovs(LayerChoice& choice, const ReadOptions& options);

/// Notes colour layers whose sums are no beauty, whatever is done to them.
void note_divided_aovs(LayerChoice& choice);

}  // namespace polyrecon
