#include "samples/generator/rig.h"

#include <algorithm>

#include "core/index.h"
#include "math/quaternion.h"
#include "motion/hips_root.h"

namespace krok::samples {

namespace {

Clip with_root(const Clip& clip, Rig rig) {
  Clip result;
  result.rate = clip.rate;
  result.provenance = clip.provenance;
  result.skeleton.add("Reference", Skeleton::kNoParent, {});
  for (int j = 0; j < clip.joint_count(); ++j) {
    result.skeleton.add(clip.skeleton.names[at(j)], clip.skeleton.parents[at(j)] + 1,
                        clip.skeleton.reference[at(j)], clip.skeleton.end_sites[at(j)] != 0);
  }
  result.resize(clip.frame_count());
  for (int f = 0; f < clip.frame_count(); ++f) {
    Transform root;
    if (rig == Rig::ground_root) root = ground_frame(clip, 0, f).to_world();
    result.frame_positions(f)[0] = root.position.cast<float>();
    result.frame_orientations(f)[0] = root.orientation.cast<float>();
    std::ranges::copy(clip.frame_positions(f), result.frame_positions(f).begin() + 1);
    std::ranges::copy(clip.frame_orientations(f), result.frame_orientations(f).begin() + 1);
  }
  return result;
}

}  // namespace

Clip with_rig(const Clip& clip, Rig rig) {
  if (rig == Rig::static_root || rig == Rig::ground_root) return with_root(clip, rig);
  Clip result = clip;
  if (rig == Rig::lying) {
    const Transform down{Vec3::Zero(), axis_rotation(Axis::x, -kPi / 2)};
    for (Transform& joint : result.skeleton.reference) joint = down * joint;
  }
  return result;
}

}  // namespace krok::samples
