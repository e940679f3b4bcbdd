#pragma once

#include "io/layers/layer_choice.h"
#include "polyrecon/read_options.h"
#include "polyrecon/roles.h"

namespace polyrecon {

/// Notes a layer that has the name of a role without the number of channels that the role needs.
void note_misshapen(LayerChoice& choice, const RoleInfo& info);

/// Notes layers that seem to be the feature by the words of their names, which no renderer is known to use.
void note_seeming(LayerChoice& choice, const RoleInfo& info);

/// Notes layers that are variances by their names while the layers that they accompany are missing, where the noise of
/// the beauty is unknown: it may be theirs.
void note_lone_variances(LayerChoice& choice, const ReadOptions& options);

/// Notes that the file has several pictures, unless one of them was chosen.
void note_pictures(LayerChoice& choice, const ReadOptions& options);

/// Notes the pictures without features that another picture of the file has, before any of them was chosen.
void note_uneven_pictures(LayerChoice& choice, const ReadOptions& options);

/// Notes the beauties that stay as they are: a picture has one.
void note_other_beauties(LayerChoice& choice, const ReadOptions& options);

/// Notes a layer with the name of one eye next to a beauty without a view: it may be a light, or the other eye.
void note_lone_eye(LayerChoice& choice, const ReadOptions& options);

/// Repeats what `merge` noted of the noise of the file.
void note_shared_samples(LayerChoice& choice, const ReadOptions& options);

/// Notes a picture that this program has denoised already.
void note_own_result(LayerChoice& choice, const Layer& beauty, const ReadOptions& options);

}  // namespace polyrecon
