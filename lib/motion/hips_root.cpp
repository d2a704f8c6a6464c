#include "motion/hips_root.h"

#include <algorithm>
#include <array>
#include <optional>

#include "core/index.h"
#include "math/quaternion.h"
#include "motion/ground_frame.h"

namespace krok {

namespace {

// Within the rounding of files with four or five decimals.
constexpr double kSamePlace = 1e-4;  // metres
constexpr double kSameTurn = 1e-3;   // radians

bool is_same(const Transform& a, const Transform& b) {
  return (a.position - b.position).norm() <= kSamePlace &&
         angle_between(a.orientation, b.orientation) <= kSameTurn;
}

std::string appended_name(const Skeleton& skeleton, int joint) {
  std::string name = skeleton.names[at(joint)] + " above hips";
  while (skeleton.find(name) >= 0) name += "'";
  return name;
}

}  // namespace

HipsRoot::HipsRoot(std::span<const Clip* const> clips, int carrier) : carrier_(carrier) {
  if (clips.empty()) return;
  const Skeleton& skeleton = clips.front()->skeleton;
  joints_ = skeleton.joint_count();
  if (joints_ == 0) return;
  below_ = subtree(skeleton, carrier);
  for (int j = skeleton.parents[at(carrier)]; j >= 0; j = skeleton.parents[at(j)]) {
    above_.insert(above_.begin(), {j, Keeps::nothing, {}, -1});
  }
  for (int j = 1; j < joints_; ++j) {
    const bool is_above = subtree(skeleton, j)[at(carrier)] != 0;
    if (!is_above && below_[at(j)] == 0) beside_.push_back(j);
  }
  find_what_is_kept(clips);
  int count = joints_;
  for (Above& above : above_) {
    if (above.keeps == Keeps::nothing) above.appended = count++;
  }
}

HipsRoot::HipsRoot(const Clip& clip, int carrier)
    : HipsRoot(std::array<const Clip*, 1>{&clip}, carrier) {}

void HipsRoot::find_what_is_kept(std::span<const Clip* const> clips) {
  constexpr std::array kAll = {Keeps::world, Keeps::to_hips, Keeps::to_parent};
  std::vector<Transform> pose(at(joints_));
  const auto relative = [&](int joint, Keeps keeps) -> Transform {
    if (keeps == Keeps::world) return pose[at(joint)];
    const int parent = clips.front()->skeleton.parents[at(joint)];
    if (keeps == Keeps::to_parent && parent < 0) return pose[at(joint)];
    return pose[at(keeps == Keeps::to_hips ? carrier_ : parent)].inverse() * pose[at(joint)];
  };
  for (Above& above : above_) {
    std::array<bool, kAll.size()> same = {true, true, true};
    std::array<std::optional<Transform>, kAll.size()> first;
    for (const Clip* clip : clips) {
      std::array<Transform, kAll.size()> begin;
      for (int f = 0; f < clip->frame_count(); ++f) {
        clip->get_pose(f, pose);
        for (std::size_t k = 0; k < kAll.size(); ++k) {
          if (!same[k]) continue;
          const Transform now = relative(above.joint, kAll[k]);
          if (f == 0) begin[k] = now;
          if (!first[k]) first[k] = now;
          same[k] = is_same(begin[k], now);
        }
        if (std::ranges::none_of(same, [](bool one) { return one; })) break;
      }
    }
    for (std::size_t k = 0; k < kAll.size() && above.keeps == Keeps::nothing; ++k) {
      if (!same[k] || !first[k]) continue;
      above.keeps = kAll[k];
      above.kept = *first[k];
    }
  }
}

void HipsRoot::stand_at(const Transform& root_to_world) {
  if (stands()) above_.front().kept = root_to_world;
}

Skeleton HipsRoot::rooted(const Skeleton& skeleton) const {
  if (!changes()) return skeleton;
  Skeleton result = skeleton;
  const Transform& hips = skeleton.reference[at(carrier_)];
  for (const Above& above : above_) result.reference[at(above.joint)] = hips;
  for (const int j : beside_) {
    result.reference[at(j)] =
        result.reference[at(skeleton.parents[at(j)])] * skeleton.reference_local(j);
  }
  const Transform ground = GroundFrame{hips.position.x(), hips.position.z(), 0}.to_world();
  for (const Above& above : above_) {
    if (above.appended < 0) continue;
    result.add(appended_name(result, above.joint), 0,
               hips * (ground.inverse() * skeleton.reference[at(above.joint)]));
  }
  return result;
}

Clip HipsRoot::rooted(const Clip& clip) const {
  if (!changes()) return clip;
  Clip result{rooted(clip.skeleton), clip.rate, {}, {}, clip.provenance};
  result.resize(clip.frame_count());
  std::vector<Transform> pose(at(joints_)), changed(result.skeleton.names.size());
  for (int f = 0; f < clip.frame_count(); ++f) {
    clip.get_pose(f, pose);
    std::ranges::copy(pose, changed.begin());
    const Transform& hips = pose[at(carrier_)];
    for (const Above& above : above_) changed[at(above.joint)] = hips;
    const Transform ground_to_hips =
        ground_frame(clip.skeleton, carrier_, hips).to_world().inverse();
    for (const Above& above : above_) {
      if (above.appended < 0) continue;
      changed[at(above.appended)] = hips * (ground_to_hips * pose[at(above.joint)]);
    }
    for (const int j : beside_) {
      const std::size_t parent = at(clip.skeleton.parents[at(j)]);
      changed[at(j)] = changed[parent] * (pose[parent].inverse() * pose[at(j)]);
    }
    result.set_pose(f, changed);
    for (std::size_t j = 0; j < pose.size(); ++j) {
      if (below_[j] == 0) continue;
      result.frame_positions(f)[j] = clip.frame_positions(f)[j];
      result.frame_orientations(f)[j] = clip.frame_orientations(f)[j];
    }
  }
  return result;
}

Clip HipsRoot::restored(const Clip& rooted, const Skeleton& skeleton,
                        const Carried& carried) const {
  Clip result{skeleton, rooted.rate, {}, {}, rooted.provenance};
  if (!changes()) {
    result.positions = rooted.positions;
    result.orientations = rooted.orientations;
    return result;
  }
  result.resize(rooted.frame_count());
  std::vector<Transform> pose(rooted.skeleton.names.size()), changed(at(joints_));
  for (int f = 0; f < rooted.frame_count(); ++f) {
    rooted.get_pose(f, pose);
    const Transform& hips = pose[at(carrier_)];
    const Transform ground = ground_frame(skeleton, carrier_, hips).to_world();
    std::copy_n(pose.begin(), joints_, changed.begin());
    for (const Above& above : above_) {
      Transform& joint = changed[at(above.joint)];
      switch (above.keeps) {
        case Keeps::world:
          joint = carried ? carried(f) * above.kept : above.kept;
          break;
        case Keeps::to_hips:
          joint = hips * above.kept;
          break;
        case Keeps::to_parent:
          joint = changed[at(skeleton.parents[at(above.joint)])] * above.kept;
          break;
        case Keeps::nothing:
          joint = ground * (hips.inverse() * pose[at(above.appended)]);
      }
    }
    for (const int j : beside_) {
      const std::size_t parent = at(skeleton.parents[at(j)]);
      changed[at(j)] = changed[parent] * (pose[parent].inverse() * pose[at(j)]);
    }
    for (Transform& joint : changed) joint.orientation = normalized_or_identity(joint.orientation);
    result.set_pose(f, changed);
    for (std::size_t j = 0; j < changed.size(); ++j) {
      if (below_[j] == 0) continue;
      result.frame_positions(f)[j] = rooted.frame_positions(f)[j];
      result.frame_orientations(f)[j] = rooted.frame_orientations(f)[j];
    }
  }
  return result;
}

int HipsRoot::original(int joint) const {
  if (!changes()) return joint;
  if (joint == 0) return carrier_;
  const auto found = std::ranges::find(above_, joint, &Above::appended);
  return found == above_.end() ? joint : found->joint;
}

std::vector<double> HipsRoot::rooted(std::span<const double> values) const {
  std::vector<double> result(values.begin(), values.end());
  if (!changes()) return result;
  result[0] = values[at(carrier_)];
  for (const Above& above : above_) {
    if (above.appended >= 0) result.push_back(values[at(above.joint)]);
  }
  return result;
}

}  // namespace krok
