#include "motion/mirror.h"

#include <algorithm>
#include <cstdint>
#include <span>

#include "core/index.h"
#include "math/quaternion.h"

namespace krok {

namespace {

// Mirrors points and rotations at x = 0; a rotation's axis is a pseudovector.
Vec3 image(const Vec3& point) {
  return {-point.x(), point.y(), point.z()};
}
Quat image(const Quat& q) {
  return {q.w(), q.x(), -q.y(), -q.z()};
}

// The bone direction of a joint in the reference pose: the sum of its paired children's offsets.
Vec3 bone(const Skeleton& skeleton, const MirrorPairs& pairs, const std::vector<int>& children,
          int joint) {
  Vec3 sum = Vec3::Zero();
  for (const int child : children) {
    if (pairs.partners[at(child)] == MirrorPairs::kNone) continue;
    sum += skeleton.reference[at(child)].position - skeleton.reference[at(joint)].position;
  }
  return sum;
}

// For each joint the rotation from its reference bone to the mirror image of its counterpart's; the
// identity for symmetric skeletons. Joints with no bone or a very short one take their parent's.
// Middle joints where limbs branch off have no single direction: identity.
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

constexpr double kStill = 2 * kRadiansPerDegree;     // relative to the parent, over the whole clip
constexpr double kTwisted = 60 * kRadiansPerDegree;  // the turn by mirroring

// 1 for joints that are not part of the body and do not rotate relative to their parents.
std::vector<std::uint8_t> still_joints(const Clip& clip, const MirrorPairs& pairs) {
  std::vector<std::uint8_t> still(clip.skeleton.names.size(), 0);
  if (pairs.in_body.empty() || clip.frame_count() == 0) return still;
  std::vector<Transform> pose(still.size());
  std::vector<Quat> first(still.size());
  const auto local = [&](std::size_t j) {
    const int parent = clip.skeleton.parents[j];
    return Quat(pose[at(parent)].orientation.conjugate() * pose[j].orientation);
  };
  for (int f = 0; f < clip.frame_count(); ++f) {
    clip.get_pose(f, pose);
    for (std::size_t j = 1; j < still.size(); ++j) {
      if (pairs.in_body[j] != 0 || (f > 0 && still[j] == 0)) continue;
      if (f == 0) first[j] = local(j);
      still[j] = angle_between(first[j], local(j)) <= kStill ? 1 : 0;
    }
  }
  return still;
}

// Mirrors poses of one skeleton.
class PoseMirror {
 public:
  PoseMirror(const Skeleton& skeleton, const MirrorPairs& pairs)
      : skeleton_(skeleton),
        pairs_(pairs),
        lopsided_(lopsidedness(skeleton, pairs)),
        kept_(skeleton.names.size(), 0),
        turns_(kept_.size()),
        new_turns_(kept_.size()) {
    for (std::size_t j = 1; j < kept_.size(); ++j) {
      kept_[j] = pairs.partners[j] == MirrorPairs::kNone ? 1 : 0;
    }
  }

  // Makes still joints follow their parents if mirroring `pose` would turn them far from their
  // present rotation.
  void keep_twisted(std::span<const Transform> pose, std::span<const std::uint8_t> still) {
    std::vector<Transform> mirrored(pose.size());
    begin(pose);
    for (int j = 0; j < skeleton_.joint_count(); ++j) {
      place(j, pose, mirrored);
      if (still[at(j)] == 0 || kept_[at(j)] != 0 || still[at(pairs_.partners[at(j)])] == 0) {
        continue;
      }
      const auto parent = at(skeleton_.parents[at(j)]);
      const Quat before = pose[parent].orientation.conjugate() * pose[at(j)].orientation;
      const Quat after = mirrored[parent].orientation.conjugate() * mirrored[at(j)].orientation;
      if (angle_between(before, after) <= kTwisted) continue;
      kept_[at(j)] = 1;
      place(j, pose, mirrored);
    }
  }

  void operator()(std::span<const Transform> pose, std::span<Transform> mirrored) {
    begin(pose);
    for (int j = 0; j < skeleton_.joint_count(); ++j) place(j, pose, mirrored);
  }

 private:
  const Quat& reference_turn(int joint) const { return skeleton_.reference[at(joint)].orientation; }

  void begin(std::span<const Transform> pose) {
    for (int j = 0; j < skeleton_.joint_count(); ++j) {
      turns_[at(j)] = pose[at(j)].orientation * reference_turn(j).conjugate();
    }
  }

  // Requires the mirrored transforms of the ancestors.
  void place(int j, std::span<const Transform> pose, std::span<Transform> mirrored) {
    const std::vector<Transform>& reference = skeleton_.reference;
    const int parent = skeleton_.parents[at(j)];
    Transform& joint = mirrored[at(j)];
    if (parent >= 0 && kept_[at(j)] != 0) {
      joint = mirrored[at(parent)] * (pose[at(parent)].inverse() * pose[at(j)]);
      new_turns_[at(j)] = joint.orientation * reference_turn(j).conjugate();
      return;
    }
    const int source = parent < 0 ? j : pairs_.partners[at(j)];
    new_turns_[at(j)] = normalized_or_identity(image(turns_[at(source)]) * lopsided_[at(j)]);
    joint.orientation = normalized_or_identity(new_turns_[at(j)] * reference_turn(j));
    if (parent < 0) {
      // Mirrors about the plane of symmetry, which the root may be off.
      const Vec3 across(2 * (pairs_.plane - reference[at(j)].position.x()), 0, 0);
      joint.position = image(Vec3(pose[at(j)].position + turns_[at(j)] * across));
      return;
    }
    // The joint's offset from its position by the parent's rotation alone.
    const int above = skeleton_.parents[at(source)];
    const Vec3 offset = reference[at(source)].position - reference[at(above)].position;
    const Vec3 stray =
        pose[at(source)].position - pose[at(above)].position - turns_[at(above)] * offset;
    const Vec3 own_offset = reference[at(j)].position - reference[at(parent)].position;
    joint.position =
        mirrored[at(parent)].position + new_turns_[at(parent)] * own_offset + image(stray);
  }

  const Skeleton& skeleton_;
  const MirrorPairs& pairs_;
  std::vector<Quat> lopsided_;
  std::vector<std::uint8_t> kept_;       // [joints], 1: follows its parent
  std::vector<Quat> turns_, new_turns_;  // from the reference pose
};

}  // namespace

Clip mirror(const Clip& clip, const MirrorPairs& pairs) {
  PoseMirror mirror_pose(clip.skeleton, pairs);
  Clip result = clip;
  std::vector<Transform> pose(clip.skeleton.names.size()), mirrored(pose.size());
  if (clip.frame_count() > 0) {
    clip.get_pose(clip.frame_count() - 1, pose);
    mirror_pose.keep_twisted(pose, still_joints(clip, pairs));
  }
  for (int f = 0; f < clip.frame_count(); ++f) {
    clip.get_pose(f, pose);
    mirror_pose(pose, mirrored);
    result.set_pose(f, mirrored);
  }
  return result;
}

}  // namespace krok
