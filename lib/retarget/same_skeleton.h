#pragma once

#include <optional>
#include <vector>

#include "scene/skeleton.h"

namespace krok::retarget {

// Two skeletons with the same names and bones, in any order of joints and any reference poses.
struct SameSkeleton {
  double scale = 1;               // lengths of the target over those of the source; exactly 1 if
                                  // equal within a millionth
  std::vector<int> source_joint;  // [target joints]
};

// Whether the target is the source, uniformly scaled: the same names, the same parents, and each
// joint at the same offset from its parent within a thousandth of a per cent of the skeleton. Empty
// if not. Skeletons of one joint, or of bones of zero length, are the same at scale 1.
std::optional<SameSkeleton> same_skeleton(const Skeleton& source, const Skeleton& target);

}  // namespace krok::retarget
