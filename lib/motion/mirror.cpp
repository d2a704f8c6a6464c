#include "motion/mirror.h"

#include <algorithm>

#include "math/quaternion.h"

namespace krok {

namespace {

std::size_t at(int joint) {
  return static_cast<std::size_t>(joint);
}

// The mirror at x = 0, for points and for rotations: a rotation's axis is turned round as well.
Vec3 image(const Vec3& point) {
  return {-point.x(), point.y(), point.z()};
}
Quat image(const Quat& q) {
  return {q.w(), q.x(), -q.y(), -q.z()};
}

// Where a joint's bones point in the reference pose, the sum of its children's offsets.
Vec3 bone(const Skeleton& skeleton, const MirrorPairs& pairs, const std::vector<int>& children,
          int joint) {
  Vec3 sum = Vec3::Zero();
  for (const int child : children) {
    if (pairs.partners[at(child)] == MirrorPairs::kNone) continue;
    sum += skeleton.reference[at(child)].position - skeleton.reference[at(joint)].position;
  }
  return sum;
}

// For each joint the turn from its own reference bone to the mirror image of its partner's;
// the identity for symmetric figures. A joint without bones takes its parent's, as do very short
// ones. The middle joints from which limbs branch off have no single direction: identity.
std::vector<Quat> lopsidedness(const Skeleton& skeleton, const MirrorPairs& pairs) {
  const auto children = skeleton.children();
  const double least = 0.01 * reference_extent(skeleton);
  std::vector<Quat> turns(skeleton.names.size(), Quat::Identity());
  for (int j = 1; j < skeleton.joint_count(); ++j) {
    const int other = pairs.partners[at(j)];
    if (other == MirrorPairs::kNone) continue;
    if (other == j && children[at(j)].size() > 1) continue;
    const Vec3 own = bone(skeleton, pairs, children[at(j)], j);
    const Vec3 theirs = bone(skeleton, pairs, children[at(other)], other);
    const int parent = skeleton.parents[at(j)];
    if (std::min(own.norm(), theirs.norm()) > least) {
      turns[at(j)] = shortest_arc(own, image(theirs));
    } else if (pairs.partners[at(parent)] == skeleton.parents[at(other)]) {
      turns[at(j)] = turns[at(parent)];
    }
  }
  return turns;
}

}  // namespace

Clip mirror(const Clip& clip, const MirrorPairs& pairs) {
  const Skeleton& skeleton = clip.skeleton;
  const int joints = clip.joint_count();
  const std::vector<Transform>& reference = skeleton.reference;
  const std::vector<Quat> lopsided = lopsidedness(skeleton, pairs);
  Clip result = clip;
  std::vector<Transform> pose(skeleton.names.size()), mirrored(pose.size());
  std::vector<Quat> turns(pose.size()), new_turns(pose.size());  // from the reference pose
  for (int f = 0; f < clip.frame_count(); ++f) {
    clip.get_pose(f, pose);
    for (int j = 0; j < joints; ++j) {
      turns[at(j)] = pose[at(j)].orientation * reference[at(j)].orientation.conjugate();
    }
    for (int j = 0; j < joints; ++j) {
      const int other = pairs.partners[at(j)];
      const int parent = skeleton.parents[at(j)];
      Transform& joint = mirrored[at(j)];
      if (parent >= 0 && other == MirrorPairs::kNone) {
        joint = mirrored[at(parent)] * (pose[at(parent)].inverse() * pose[at(j)]);
        new_turns[at(j)] = joint.orientation * reference[at(j)].orientation.conjugate();
        continue;
      }
      const int source = parent < 0 ? j : other;
      new_turns[at(j)] = normalized_or_identity(image(turns[at(source)]) * lopsided[at(j)]);
      joint.orientation = normalized_or_identity(new_turns[at(j)] * reference[at(j)].orientation);
      if (parent < 0) {
        // The figure's plane, not the root, is what the mirror holds on to.
        const Vec3 across(2 * (pairs.plane - reference[at(j)].position.x()), 0, 0);
        joint.position = image(Vec3(pose[at(j)].position + turns[at(j)] * across));
        continue;
      }
      // What the joint stands off from where its parent's turn alone would put it.
      const int above = skeleton.parents[at(source)];
      const Vec3 offset = reference[at(source)].position - reference[at(above)].position;
      const Vec3 stray =
          pose[at(source)].position - pose[at(above)].position - turns[at(above)] * offset;
      const Vec3 own_offset = reference[at(j)].position - reference[at(parent)].position;
      joint.position =
          mirrored[at(parent)].position + new_turns[at(parent)] * own_offset + image(stray);
    }
    result.set_pose(f, mirrored);
  }
  return result;
}

}  // namespace krok
