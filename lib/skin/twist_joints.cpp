#include "skin/twist_joints.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include "core/index.h"
#include "math/quaternion.h"

namespace krok {

namespace {

constexpr std::string_view kOfStart = "_untwist", kOfEnd = "_twist";
constexpr double kLeastBone = 1e-4;  // metres

bool is_twist_joint(const Skeleton& skeleton, int joint, bool of_start) {
  const int parent = skeleton.parents[at(joint)];
  if (parent < 0) return false;
  const std::string stem = skeleton.names[at(parent)] + std::string(of_start ? kOfStart : kOfEnd);
  const std::string& name = skeleton.names[at(joint)];
  return name.size() == stem.size() + 1 && name.starts_with(stem) && name.back() >= '1' &&
         name.back() <= '8';
}
bool is_twist_joint(const Skeleton& skeleton, int joint) {
  return is_twist_joint(skeleton, joint, true) || is_twist_joint(skeleton, joint, false);
}

// The farthest child of a joint that is no twist joint, or -1.
int end_of(const Skeleton& skeleton, int joint) {
  int end = -1;
  double farthest = kLeastBone;
  for (int j = joint + 1; j < skeleton.joint_count(); ++j) {
    if (skeleton.parents[at(j)] != joint || is_twist_joint(skeleton, j)) continue;
    const double distance = skeleton.reference_local(j).position.norm();
    if (distance > farthest) std::tie(end, farthest) = std::pair(j, distance);
  }
  return end;
}

// The twist of swing * twist about an axis, within half a turn; 0 for a swing of half a turn.
double twist_about(const Vec3& axis, const Quat& q) {
  const double along = q.vec().dot(axis);
  if (std::hypot(along, q.w()) < 1e-12) return 0;
  return 2 * (q.w() < 0 ? std::atan2(-along, -q.w()) : std::atan2(along, q.w()));
}

// Shares out the influence of a bone's joint among its twist joints, `first` and those after it.
void share_out(const TwistBone& bone, int first, const Vec3& start, const Vec3& along,
               Model& model) {
  const auto places = at(model.influences_per_vertex),
             more = std::min<std::size_t>(places + 1, Model::kMaxInfluences);
  std::vector<std::uint16_t> joints;
  std::vector<float> weights;
  std::vector<std::pair<float, std::uint16_t>> all;
  for (std::size_t v = 0; v < model.positions.size(); ++v) {
    all.clear();
    for (std::size_t k = 0; k < places; ++k) {
      const float weight = model.influence_weights[v * places + k];
      const std::uint16_t joint = model.influence_joints[v * places + k];
      if (!(weight > 0) || joint != bone.joint) {
        all.emplace_back(weight, joint);
        continue;
      }
      // In steps of one twist joint from the start of the bone, where joint k is at k.
      const Vec3 from = model.positions[v].cast<double>() - start;
      const double step = from.dot(along) / along.squaredNorm() * (bone.count + 1);
      const double place = bone.of_start ? std::clamp(step, 1.0, bone.count + 1.0)
                                         : std::clamp(step, 0.0, double(bone.count));
      const int before = std::min(static_cast<int>(place), bone.count);
      const auto joint_at = [&](int at) {
        const bool is_own = at == 0 || at == bone.count + 1;
        return static_cast<std::uint16_t>(is_own ? bone.joint : first + at - 1);
      };
      const auto share = static_cast<float>(place - before);
      all.emplace_back(weight * (1 - share), joint_at(before));
      if (share > 0) all.emplace_back(weight * share, joint_at(before + 1));
    }
    std::ranges::stable_sort(all, std::greater<>(), &std::pair<float, std::uint16_t>::first);
    all.resize(more);
    for (const auto& [weight, joint] : all) {
      weights.push_back(weight);
      joints.push_back(joint);
    }
  }
  model.influences_per_vertex = static_cast<int>(more);
  model.influence_joints = std::move(joints);
  model.influence_weights = std::move(weights);
  normalize_influences(model);
}

}  // namespace

Status add_twist_joints(Model& model, std::span<const TwistBone> bones) {
  for (const TwistBone& bone : bones) {
    Skeleton& skeleton = model.skeleton;
    const std::string name = skeleton.names[at(bone.joint)];
    const auto fail = [&](std::string what, std::string hint) {
      Error error("twist-joints", fmt::format("the bone of {} {}", name, what), std::move(hint));
      error.joint = name;
      return error;
    };
    const int end = end_of(skeleton, bone.joint);
    if (end < 0) return fail("has no length", "twist joints need a joint at its other end");
    if (bone.count < 1 || bone.count > 8) return fail("cannot have so many twist joints", "1 to 8");
    for (int j = 0; j < skeleton.joint_count(); ++j) {
      if (skeleton.parents[at(j)] == bone.joint && is_twist_joint(skeleton, j)) {
        return fail("has twist joints already", "add them once");
      }
    }
    const Transform start = skeleton.reference[at(bone.joint)];
    const Vec3 along = skeleton.reference[at(end)].position - start.position;
    const int first = skeleton.joint_count();
    for (int k = 1; k <= bone.count; ++k) {
      const double share = static_cast<double>(k) / (bone.count + 1);
      skeleton.add(fmt::format("{}{}{}", name, bone.of_start ? kOfStart : kOfEnd, k), bone.joint,
                   {start.position + share * along, start.orientation});
    }
    share_out(bone, first, start.position, along, model);
  }
  return {};
}

void carry_twist_joints(const Skeleton& model, Clip& motion, Stretches& stretches) {
  struct Carried {
    int bone, end;                       // in the motion
    Transform reference, end_reference;  // relative to the bone
    Quat bone_reference;                 // relative to its parent
    Vec3 axis;
    double share, before;  // before: the twist of the frame before
    bool of_start;
  };
  std::vector<Carried> all;
  Skeleton& skeleton = motion.skeleton;
  const std::size_t joints = skeleton.names.size();
  for (int j = 0; j < model.joint_count(); ++j) {
    if (!is_twist_joint(model, j) || skeleton.find(model.names[at(j)]) >= 0) continue;
    const int parent = model.parents[at(j)], model_end = end_of(model, parent);
    const int bone = skeleton.find(model.names[at(parent)]);
    const int end = model_end < 0 ? -1 : skeleton.find(model.names[at(model_end)]);
    if (bone < 0 || end < 0) continue;
    Carried one{bone,
                end,
                model.reference_local(j),
                model.reference_local(model_end),
                model.reference_local(parent).orientation,
                {},
                0,
                0,
                is_twist_joint(model, j, true)};
    one.axis = one.end_reference.position.normalized();
    one.share = one.reference.position.norm() / one.end_reference.position.norm();
    all.push_back(one);
    skeleton.add(model.names[at(j)], bone, skeleton.reference[at(bone)] * one.reference);
  }
  if (all.empty()) return;
  const int frames = static_cast<int>(motion.positions.size() / joints);
  Clip more;
  more.skeleton = skeleton;
  more.resize(frames);
  Stretches more_stretches;
  std::vector<Transform> pose(skeleton.names.size());
  for (int frame = 0; frame < frames; ++frame) {
    for (std::size_t j = 0; j < joints; ++j) {
      const std::size_t from = at(frame) * joints + j;
      pose[j] = {motion.positions[from].cast<double>(),
                 motion.orientations[from].cast<double>().normalized()};
    }
    for (std::size_t k = 0; k < all.size(); ++k) {
      Carried& one = all[k];
      const Transform& bone = pose[at(one.bone)];
      const int parent = skeleton.parents[at(one.bone)];
      const Quat above = parent < 0 ? Quat::Identity() : pose[at(parent)].orientation;
      double twist =
          one.of_start
              ? twist_about(one.axis,
                            one.bone_reference.conjugate() * above.conjugate() * bone.orientation)
              : twist_about(one.axis, bone.orientation.conjugate() * pose[at(one.end)].orientation *
                                          one.end_reference.orientation.conjugate());
      twist += 2 * kPi * std::round((one.before - twist) / (2 * kPi));
      one.before = twist;
      const double turn = one.of_start ? (one.share - 1) * twist : one.share * twist;
      pose[joints + k] =
          bone * one.reference * Transform{Vec3::Zero(), from_rotation_vector(turn * one.axis)};
    }
    more.set_pose(frame, pose);
    for (std::size_t j = 0; j < joints; ++j) {  // bit for bit
      more.frame_positions(frame)[j] = motion.positions[at(frame) * joints + j];
      more.frame_orientations(frame)[j] = motion.orientations[at(frame) * joints + j];
    }
    if (stretches.empty()) continue;
    const auto from = stretches.begin() + static_cast<std::ptrdiff_t>(at(frame) * joints);
    more_stretches.insert(more_stretches.end(), from, from + static_cast<std::ptrdiff_t>(joints));
    for (const Carried& one : all) more_stretches.push_back(from[one.bone]);
  }
  motion.positions = std::move(more.positions);
  motion.orientations = std::move(more.orientations);
  stretches = std::move(more_stretches);
}

}  // namespace krok
