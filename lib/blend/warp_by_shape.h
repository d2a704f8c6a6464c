#pragma once

#include <span>

#include "blend/correspondence.h"
#include "roles/roles.h"
#include "scene/clip.h"

// Correspondences where there are no keytimes: proposed from how alike the poses are.

namespace krok::blend {

struct ShapeWarpOptions {
  double spacing = 0.25;  // seconds of the first motion between the moments that come out
  double band = 0.2;      // how far a moment may be from the same part of the whole, 0 to 1
  int jobs = 0;           // threads; 0: as many as processors
};

// Dynamic time warping of each motion against the first, from their beginnings to their ends. The
// distance of two poses is the root mean square of the joints' distances as seen from the figure's
// place and heading (metres), and of their velocities' over a tenth of a second. Steps are those of
// Sakoe and Chiba's symmetric form with slope limit 1 (Dynamic programming algorithm optimization
// for spoken word recognition, IEEE ASSP 26, 1978): relative to going evenly through both, a motion
// is nowhere more than twice as fast or as slow. Poses are compared at up to 1,000 moments.
//
// Clips of one skeleton. Codes: blend-duration for clips of fewer than two frames.
Result<Correspondence> warp_by_shape(std::span<const Clip* const> clips, const RoleMap& roles,
                                     const ShapeWarpOptions& options = {});

}  // namespace krok::blend
