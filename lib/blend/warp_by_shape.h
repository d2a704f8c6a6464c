#pragma once

#include <span>

#include "blend/correspondence.h"
#include "roles/roles.h"
#include "scene/clip.h"

// Time correspondence without keytimes, from pose similarity.

namespace krok::blend {

struct ShapeWarpOptions {
  double spacing = 0.25;  // seconds of the first motion between result moments
  double band = 0.2;      // half-width of the search band, as a fraction of the duration, 0 to 1
  int jobs = 0;           // threads; 0: one per processor
};

// Dynamic time warping of each motion against the first, from start to end. The pose distance is
// the root mean square over joints of the position differences relative to the character's ground
// frame (metres) and of the velocity differences over 0.1 s. Steps follow Sakoe and Chiba's
// symmetric form with slope limit 1 (Dynamic programming algorithm optimization for spoken word
// recognition, IEEE ASSP 26, 1978): relative to a uniform time scale, a motion is never sped up or
// slowed down by more than a factor of two. Poses are compared at up to 1,000 moments.
//
// Clips must have the same skeleton. Code: blend-duration for clips of fewer than two frames.
Result<Correspondence> warp_by_shape(std::span<const Clip* const> clips, const RoleMap& roles,
                                     const ShapeWarpOptions& options = {});

}  // namespace krok::blend
