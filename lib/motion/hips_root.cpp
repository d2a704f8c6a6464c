#include "motion/hips_root.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>

#include "core/index.h"
#include "math/quaternion.h"

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

// What stays the same of each joint above the hips, over the frames of some clips.
class HipsRoot::KeptFinder {
 public:
  KeptFinder(HipsRoot& root, const Skeleton& skeleton)
      : root_(root),
        parents_(skeleton.parents),
        found_(root.above_.size()),
        pose_(at(root.joints_)) {}

  // `begins`: the first frame is that of a clip.
  void add(const Clip& frames, bool begins) {
    for (int f = 0; f < frames.frame_count(); ++f) {
      if (std::ranges::none_of(found_, &Found::any)) return;
      frames.get_pose(f, pose_);
      for (std::size_t i = 0; i < found_.size(); ++i) {
        Found& found = found_[i];
        for (std::size_t k = 0; k < kAll.size(); ++k) {
          if (!found.same[k]) continue;
          const Transform now = relative(root_.above_[i].joint, kAll[k]);
          if (begins && f == 0) found.begin[k] = now;
          if (!found.first[k]) found.first[k] = now;
          found.same[k] = is_same(found.begin[k], now);
        }
      }
    }
  }

  void finish() {
    int count = root_.joints_;
    for (std::size_t i = 0; i < found_.size(); ++i) {
      Above& above = root_.above_[i];
      for (std::size_t k = 0; k < kAll.size() && above.keeps == Keeps::nothing; ++k) {
        if (!found_[i].same[k] || !found_[i].first[k]) continue;
        above.keeps = kAll[k];
        above.kept = *found_[i].first[k];
      }
      if (above.keeps == Keeps::nothing) above.appended = count++;
    }
  }

 private:
  static constexpr std::array kAll = {Keeps::world, Keeps::to_hips, Keeps::to_parent};
  struct Found {
    std::array<bool, kAll.size()> same = {true, true, true};
    std::array<Transform, kAll.size()> begin;
    std::array<std::optional<Transform>, kAll.size()> first;
    bool any() const { return same[0] || same[1] || same[2]; }
  };

  Transform relative(int joint, Keeps keeps) const {
    const int parent = parents_[at(joint)];
    if (keeps == Keeps::world || (keeps == Keeps::to_parent && parent < 0)) return pose_[at(joint)];
    return pose_[at(keeps == Keeps::to_hips ? root_.carrier_ : parent)].inverse() *
           pose_[at(joint)];
  }

  HipsRoot& root_;
  const std::vector<int>& parents_;
  std::vector<Found> found_;  // of HipsRoot::above_
  std::vector<Transform> pose_;
};

void HipsRoot::find_joints(const Skeleton& skeleton) {
  joints_ = skeleton.joint_count();
  if (joints_ == 0) return;
  below_ = subtree(skeleton, carrier_);
  for (int j = skeleton.parents[at(carrier_)]; j >= 0; j = skeleton.parents[at(j)]) {
    above_.insert(above_.begin(), {j, Keeps::nothing, {}, -1});
  }
  for (int j = 1; j < joints_; ++j) {
    const bool is_above = subtree(skeleton, j)[at(carrier_)] != 0;
    if (!is_above && below_[at(j)] == 0) beside_.push_back(j);
  }
}

HipsRoot::HipsRoot(std::span<const Clip* const> clips, int carrier) : carrier_(carrier) {
  if (clips.empty()) return;
  find_joints(clips.front()->skeleton);
  KeptFinder finder(*this, clips.front()->skeleton);
  for (const Clip* clip : clips) finder.add(*clip, true);
  finder.finish();
}

HipsRoot::HipsRoot(const Clip& clip, int carrier)
    : HipsRoot(std::array<const Clip*, 1>{&clip}, carrier) {}

Result<HipsRoot> HipsRoot::of(const FrameSource& source, int carrier, int jobs) {
  return of(std::span(&source, 1), carrier, jobs);
}

Result<HipsRoot> HipsRoot::of(std::span<const FrameSource> sources, int carrier, int jobs) {
  HipsRoot root;
  root.carrier_ = carrier;
  root.find_joints(sources.front().skeleton);
  if (!root.changes()) return root;
  KeptFinder finder(root, sources.front().skeleton);
  for (const FrameSource& source : sources) {
    const Status status = for_each_block(source, jobs, [&](int first, const Clip& block) {
      finder.add(block, first == 0);
      return Status();
    });
    if (!status) return status.error();
  }
  finder.finish();
  return root;
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

Transform GroundFrame::to_world() const {
  return {Vec3(x, 0, z), axis_rotation(Axis::y, heading)};
}

int carrying_joint(const RoleMap& roles) {
  return std::max(0, roles.joint(Role::hips));
}

GroundFrame ground_frame(const Skeleton& skeleton, int carrier, const Transform& carrier_to_world) {
  const Quat& reference = skeleton.reference[static_cast<std::size_t>(carrier)].orientation;
  const Quat turn = carrier_to_world.orientation * reference.conjugate();
  // Swing-twist decomposition: the twist about an axis is the quaternion's part along it. It is
  // undefined upside down by exactly half a turn.
  const double heading =
      turn.y() == 0 && turn.w() == 0 ? 0 : wrapped(2 * std::atan2(turn.y(), turn.w()));
  return {carrier_to_world.position.x(), carrier_to_world.position.z(), heading};
}

GroundFrame ground_frame(const Clip& clip, int carrier, int frame) {
  const auto c = static_cast<std::size_t>(carrier);
  return ground_frame(clip.skeleton, carrier,
                      {clip.frame_positions(frame)[c].cast<double>(),
                       clip.frame_orientations(frame)[c].cast<double>().normalized()});
}

double wrapped(double angle) {
  return std::remainder(angle, 2 * kPi);
}

std::vector<int> foot_joints(const Skeleton& skeleton, const RoleMap& roles) {
  std::vector<int> feet;
  std::vector<std::uint8_t> of_foot(skeleton.names.size(), 0);
  for (std::size_t j = 0; j < of_foot.size(); ++j) {
    const Role role = roles.roles[j];
    const int parent = skeleton.parents[j];
    of_foot[j] = role == Role::left_foot || role == Role::right_foot || role == Role::left_toes ||
                 role == Role::right_toes ||
                 (role == Role::end && parent >= 0 && of_foot[static_cast<std::size_t>(parent)]);
    if (of_foot[j]) feet.push_back(static_cast<int>(j));
  }
  if (feet.empty()) {
    feet.resize(of_foot.size());
    std::iota(feet.begin(), feet.end(), 0);
  }
  return feet;
}

std::vector<std::uint8_t> subtree(const Skeleton& skeleton, int joint) {
  std::vector<std::uint8_t> within(skeleton.names.size(), 0);
  within[static_cast<std::size_t>(joint)] = 1;
  for (std::size_t j = static_cast<std::size_t>(joint) + 1; j < within.size(); ++j) {
    const int parent = skeleton.parents[j];
    if (parent >= 0) within[j] = within[static_cast<std::size_t>(parent)];
  }
  return within;
}

}  // namespace krok
