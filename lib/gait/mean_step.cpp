#include "gait/mean_step_internal.h"

#include <algorithm>

#include "core/index.h"
#include "pose/sample_pose.h"

namespace krok::gait {

PoseVector mean_pose(const parametric::PackedExamples& packed, double generic) {
  std::vector<PoseBlock> blocks(at(packed.reference.blocks_per_pose()));
  std::vector<Transform> local(at(packed.reference.joints));
  sample_pose(packed.reference, generic, blocks);
  unpack_pose(blocks, local);
  PoseVector pose(kPoseValues * packed.reference.joints);
  for (int j = 0; j < packed.reference.joints; ++j) {
    position_of(pose, j) = local[at(j)].position;
    rotation_of(pose, j) = local[at(j)].orientation.coeffs();
  }
  return pose;
}

double middle_of_swing(const parametric::PackedExamples& packed,
                       const parametric::Library& library) {
  const auto off = std::ranges::find(library.keytimes, "swing_off") - library.keytimes.begin();
  return 0.6 * packed.generic[static_cast<std::size_t>(off)] + 0.4 * packed.generic.back();
}

}  // namespace krok::gait
