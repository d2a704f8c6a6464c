#include "retarget/copied_frames_internal.h"

#include <algorithm>
#include <utility>

#include "core/index.h"
#include "retarget/actor_view_internal.h"
#include "retarget/moved_limb.h"
#include "retarget/stance.h"

namespace krok::retarget {

namespace {

// A joint that the source lacks: where it is in the frame of another, or in the world (-1).
struct Follower {
  int joint, carrier;
  Transform offset;
};

// On their parents as in the reference pose, a face as faces_of_motion() has it; what is beside the
// hips, and roots at their place, goes along with them; other roots stay.
std::vector<Follower> followers_of(const Clip& target, const RoleMap& roles,
                                   const SameSkeleton& same) {
  const Skeleton& skeleton = target.skeleton;
  const int hips = roles.joint(Role::hips);
  const std::vector<int> faces = faces_of_motion(target, roles);
  std::vector<Follower> followers;
  for (int k = 0; k < skeleton.joint_count(); ++k) {
    if (same.source_joint[at(k)] >= 0) continue;
    const int parent = skeleton.parents[at(k)];
    Follower follower{k, parent, skeleton.reference_local(k)};
    if (carries(skeleton, k, hips)) {
      const bool near = length_of(skeleton, k, hips) < kAtHips * leg_length(skeleton, roles);
      follower.carrier = near ? hips : -1;
    } else if (carries(skeleton, parent, hips) && parent != hips) {
      follower.carrier = hips;
    } else if (std::ranges::find(faces, k) != faces.end()) {
      follower.offset.orientation = turn_in_frame(target, k, 0);
    }
    const Transform& own = skeleton.reference[at(k)];
    if (follower.carrier < 0) follower.offset = own;
    if (follower.carrier >= 0 && follower.carrier != parent) {
      follower.offset = skeleton.reference[at(follower.carrier)].inverse() * own;
    }
    followers.push_back(follower);
  }
  return followers;
}

void follow(const Follower& follower, int frame, Clip& frames) {
  const auto positions = frames.frame_positions(frame);
  const auto orientations = frames.frame_orientations(frame);
  Transform now = follower.offset;
  if (follower.carrier >= 0) {
    now = Transform{positions[at(follower.carrier)].cast<double>(),
                    orientations[at(follower.carrier)].cast<double>()} *
          now;
  }
  positions[at(follower.joint)] = now.position.cast<float>();
  orientations[at(follower.joint)] = now.orientation.normalized().cast<float>();
}

}  // namespace

std::vector<int> faces_of_motion(const Clip& target, const RoleMap& roles) {
  const int head = roles.joint(Role::head);
  if (head < 0 || !roles.humanoid || target.frame_count() == 0) return {};
  if (is_straight({target.skeleton, roles, target.skeleton.reference})) return {};
  std::vector<int> faces = joints_below(target.skeleton, head);
  std::erase(faces, head);
  return faces;
}

Quat turn_in_frame(const Clip& target, int joint, int frame) {
  const auto turns = target.frame_orientations(frame);
  const Quatf& parent = turns[at(target.skeleton.parents[at(joint)])];
  return (parent.conjugate() * turns[at(joint)]).cast<double>().normalized();
}

RetargetedFrames copied_frames(const FrameSource& source, const Clip& target_clip,
                               const RoleMap& roles, const SameSkeleton& same) {
  const Skeleton& target = target_clip.skeleton;
  const auto copy = [target, same,
                     followers = followers_of(target_clip, roles, same)](Clip& frames) {
    const Clip before = std::exchange(frames, {});
    frames.skeleton = target;
    frames.rate = before.rate;
    frames.resize(before.frame_count());
    for (int frame = 0; frame < before.frame_count(); ++frame) {
      const auto positions = before.frame_positions(frame);
      const auto orientations = before.frame_orientations(frame);
      for (int k = 0; k < target.joint_count(); ++k) {
        if (same.source_joint[at(k)] < 0) continue;
        const auto from = at(same.source_joint[at(k)]);
        frames.frame_orientations(frame)[at(k)] = orientations[from];
        const Vec3f& position = positions[from];
        frames.frame_positions(frame)[at(k)] =
            same.scale == 1 ? position
                            : Vec3f((same.scale * position.cast<double>()).cast<float>());
      }
      for (const Follower& follower : followers) follow(follower, frame, frames);
    }
    return Status();
  };
  RetargetedFrames result{changed(source, copy), std::make_shared<Report>()};
  result.frames.skeleton = target;
  Report& report = *result.report;
  report.method = Method::same_skeleton;
  report.scale = report.path_scale = same.scale;
  report.source_pose = source.skeleton.reference;
  report.target_pose = target.reference;
  std::vector<char> used(source.skeleton.names.size(), 0);
  for (int k = 0; k < target.joint_count(); ++k) {
    const int from = same.source_joint[at(k)];
    if (from >= 0) used[at(from)] = 1;
    if (target.end_sites[at(k)] != 0) continue;
    if (from < 0) {
      report.following_target.push_back(k);
      continue;
    }
    MappedJoint& joint = report.mapped.emplace_back();
    joint.target = k;
    joint.source = from;
  }
  for (std::size_t j = 0; j < used.size(); ++j) {
    if (used[j] == 0 && source.skeleton.end_sites[j] == 0) {
      report.unused_source.push_back(static_cast<int>(j));
    }
  }
  return result;
}

}  // namespace krok::retarget
