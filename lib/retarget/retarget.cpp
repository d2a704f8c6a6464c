#include "retarget/retarget.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "core/index.h"
#include "core/parallel.h"
#include "math/quaternion.h"
#include "retarget/actor_measure_internal.h"
#include "retarget/foot_placement.h"
#include "retarget/joint_mapping.h"
#include "retarget/pose_alignment.h"
#include "retarget/same_skeleton.h"
#include "retarget/stance.h"

namespace krok::retarget {

namespace {

constexpr std::size_t kFramesATime = 64;

// Copies orientations and scales positions, without rounding except by the scale.
Retargeted copy_of(const Clip& source, const Skeleton& target, const SameSkeleton& same,
                   double scale) {
  Retargeted result;
  Clip& clip = result.clip;
  clip.skeleton = target;
  clip.rate = source.rate;
  clip.resize(source.frame_count());
  for (int frame = 0; frame < source.frame_count(); ++frame) {
    const auto positions = source.frame_positions(frame);
    const auto orientations = source.frame_orientations(frame);
    for (int k = 0; k < target.joint_count(); ++k) {
      const auto from = at(same.source_joint[at(k)]);
      clip.frame_orientations(frame)[at(k)] = orientations[from];
      const Vec3f& position = positions[from];
      clip.frame_positions(frame)[at(k)] =
          scale == 1 ? position : Vec3f((scale * position.cast<double>()).cast<float>());
    }
  }
  result.report.method = Method::same_skeleton;
  result.report.scale = scale;
  for (int k = 0; k < target.joint_count(); ++k) {
    if (target.end_sites[at(k)] != 0) continue;
    MappedJoint& joint = result.report.mapped.emplace_back();
    joint.target = k;
    joint.source = same.source_joint[at(k)];
  }
  return result;
}

std::string list_of(const std::vector<Role>& roles) {
  if (roles.size() == missing_roles({}).size()) return "every humanoid role";
  std::string text;
  for (const Role role : roles) text += (text.empty() ? "" : ", ") + std::string(role_name(role));
  return text;
}

// Describes the missing roles.
std::string missing_text(const RoleMap& source, const RoleMap& target) {
  const std::string in_source = list_of(missing_roles(source));
  const std::string in_target = list_of(missing_roles(target));
  if (in_target.empty()) return "the input lacks " + in_source;
  if (in_source.empty()) return "the target lacks " + in_target;
  return fmt::format("the input lacks {}; the target lacks {}", in_source, in_target);
}

int joints_without_ends(const Skeleton& skeleton) {
  return static_cast<int>(std::count(skeleton.end_sites.begin(), skeleton.end_sites.end(), 0));
}

// The first mapped joint, which carries the root motion.
int first_mapped(const JointMapping& mapping) {
  for (std::size_t k = 0; k < mapping.size(); ++k) {
    if (mapping[k].first >= 0) return static_cast<int>(k);
  }
  return 0;
}

// State shared by all frames.
class Transfer {
 public:
  Transfer(const Clip& source, const RoleMap& source_roles, const Clip& target,
           const RoleMap& target_roles, const Options& options)
      : source_(source),
        source_roles_(source_roles),
        target_clip_(target),
        target_(target.skeleton),
        target_roles_(target_roles),
        options_(options) {}

  Result<Retargeted> run() {
    const bool by_roles = source_roles_.humanoid && target_roles_.humanoid;
    auto source_stance = find_stance(source_, source_roles_, options_.source_frame);
    if (!source_stance) return source_stance.error();
    auto target_stance = find_stance(target_clip_, target_roles_, options_.target_frame);
    if (!target_stance) return target_stance.error();
    rest_ = std::move(source_stance->pose);
    target_rest_ = std::move(target_stance->pose);
    report_.source_frame = source_stance->frame;
    report_.target_frame = target_stance->frame;
    if (by_roles) {
      prepare_roles();
    } else if (Status status = prepare_names(); !status) {
      return status.error();
    }
    if (!(report_.scale > 0) || !std::isfinite(report_.scale)) {
      return Error("retarget-scale", "cannot compute a scale from the lengths of the skeletons",
                   "set it with --scale");
    }
    for (int k = 0; k < target_.joint_count(); ++k) {
      local_.push_back(target_.reference_local(k));
      aligned_.push_back(turns_[at(k)] * target_rest_[at(k)].orientation);
    }
    for (const Transform& joint : rest_) rest_back_.push_back(joint.orientation.conjugate());
    Retargeted result;
    result.clip = moved();
    note_joints();
    result.report = std::move(report_);
    return result;
  }

 private:
  void prepare_roles() {
    report_.method = Method::roles;
    report_.left_fingers_at_rest =
        fingers_never_move(source_, source_roles_, rest_, Role::left_hand, Role::left_fingers);
    report_.right_fingers_at_rest =
        fingers_never_move(source_, source_roles_, rest_, Role::right_hand, Role::right_fingers);
    mapping_ = map_by_roles(source_.skeleton, source_roles_, target_, target_roles_,
                            report_.left_fingers_at_rest, report_.right_fingers_at_rest);
    const Actor from{source_.skeleton, source_roles_, rest_};
    const Actor to{target_, target_roles_, target_rest_};
    turns_ = align_by_roles(from, to, mapping_);
    report_.scale = options_.scale.value_or(leg_length(target_, target_roles_) /
                                            leg_length(source_.skeleton, source_roles_));
    take_anchor_of_roles();
    source_sides_ = {source_roles_.joint(Role::left_upper_leg),
                     source_roles_.joint(Role::right_upper_leg)};
    target_sides_ = {target_roles_.joint(Role::left_upper_leg),
                     target_roles_.joint(Role::right_upper_leg)};
    prepare_feet(from, to);
  }

  // The hips. Ancestors at the same position, as in Biped, rotate and move with them.
  void take_anchor_of_roles() {
    const int hips = target_roles_.joint(Role::hips);
    const double near = 0.05 * leg_length(target_, target_roles_);
    anchor_ = hips;
    for (int j = target_.parents[at(hips)]; j >= 0 && length_of(target_, j, hips) < near;
         j = target_.parents[at(j)]) {
      anchor_ = j;
      mapping_[at(j)] = mapping_[at(hips)];
      turns_[at(j)] = turns_[at(hips)];
    }
  }

  // Thickness of the target's soles below its foot joints, if known: from its mesh, or from the
  // height of its feet in stance in its own motion.
  std::optional<double> target_sole(const Actor& to) const {
    if (options_.target_floor) {
      return std::min(lowest_of_foot(to, Role::left_foot), lowest_of_foot(to, Role::right_foot)) -
             *options_.target_floor;
    }
    if (target_clip_.frame_count() == 0) return std::nullopt;
    const double sole = standing_height(target_clip_, to);
    return is_sole(sole, leg_length(target_, target_roles_)) ? std::optional(sole) : std::nullopt;
  }

  // Whether foot joints at this height in stance have soles on a floor at 0.
  static bool is_sole(double height, double leg) {
    return height > -0.02 * leg && height < 0.08 * leg;
  }

  void prepare_feet(const Actor& from, const Actor& to) {
    const double standing = standing_height(source_, from);
    const auto sole = target_sole(to);
    if (sole && is_sole(standing, leg_length(source_.skeleton, source_roles_))) {
      source_floor_.sole = standing;
      target_floor_.sole = *sole;
    } else {
      source_floor_.motion = standing;
    }
    target_floor_.motion = report_.scale * source_floor_.motion;
    report_.floor = target_floor_.motion;
    for (const Role foot : {Role::left_foot, Role::right_foot}) {
      rise_ += 0.5 * (ankle_over_floor(to, foot, target_floor_) -
                      report_.scale * ankle_over_floor(from, foot, source_floor_));
    }
    if (options_.feet == Feet::free) return;
    for (const bool is_left : {true, false}) {
      auto leg = LegPlacement::create(from, to, turns_, report_.scale, source_floor_, target_floor_,
                                      is_left);
      if (!leg) continue;
      std::vector<double> stands = leg->standing(source_);
      legs_.push_back({std::move(*leg), std::move(stands), is_left});
    }
  }

  Status prepare_names() {
    report_.method = Method::names;
    mapping_ = map_by_names(source_.skeleton, target_);
    const auto shared =
        static_cast<int>(std::count_if(mapping_.begin(), mapping_.end(),
                                       [](const JointSource& entry) { return entry.first >= 0; }));
    const int fewer = std::min(joints_without_ends(source_.skeleton), joints_without_ends(target_));
    if (shared * 5 < fewer * 3 || shared == 0) {
      return Error("retarget-roles",
                   fmt::format("the skeletons are not both humanoid ({}), and share only {} of {} "
                               "joint names",
                               missing_text(source_roles_, target_roles_), shared, fewer),
                   "assign joint roles with --map and --onto-map; krok-info shows those found");
    }
    turns_ = align_by_names({source_.skeleton, source_roles_, rest_},
                            {target_, target_roles_, target_rest_}, mapping_);
    report_.scale = options_.scale.value_or(bone_ratio(source_.skeleton, target_, mapping_));
    anchor_ = first_mapped(mapping_);
    source_sides_ = {mapping_[at(anchor_)].first, mapping_[at(anchor_)].first};
    target_sides_ = {anchor_, anchor_};
    return {};
  }

  // The rotation of a source joint since the reference pose.
  Quat turn_of(std::span<const Transform> pose, int joint) const {
    return pose[at(joint)].orientation * rest_back_[at(joint)];
  }

  // joint_to_world of the target, with its anchor at its reference position.
  void pose_of(std::span<const Transform> source_pose, std::span<Transform> pose) const {
    for (int k = 0; k < target_.joint_count(); ++k) {
      const JointSource& from = mapping_[at(k)];
      const int parent = target_.parents[at(k)];
      if (parent < 0) {
        pose[at(k)] = target_.reference[at(k)];
      } else {
        pose[at(k)] = pose[at(parent)] * local_[at(k)];
      }
      if (from.first < 0) continue;
      Quat turn = turn_of(source_pose, from.first);
      if (from.second >= 0) turn = slerp(turn, turn_of(source_pose, from.second), from.share);
      pose[at(k)].orientation = (turn * aligned_[at(k)]).normalized();
    }
  }

  Vec3 middle(std::span<const Transform> pose, const std::array<int, 2>& sides) const {
    return 0.5 * (pose[at(sides[0])].position + pose[at(sides[1])].position);
  }

  // Moves the anchor and its descendants.
  void place(std::span<const Transform> source_pose, std::span<Transform> pose) const {
    const Vec3 goal = report_.scale * middle(source_pose, source_sides_) + rise_ * Vec3::UnitY();
    const Vec3 shift = goal - middle(pose, target_sides_);
    for (std::size_t k = 0; k < pose.size(); ++k) {
      if (below_anchor_[k] != 0) pose[k].position += shift;
    }
  }

  void find_below_anchor() {
    below_anchor_.assign(target_.names.size(), 0);
    below_anchor_[at(anchor_)] = 1;
    for (int k = anchor_ + 1; k < target_.joint_count(); ++k) {
      below_anchor_[at(k)] = below_anchor_[at(target_.parents[at(k)])];
    }
  }

  // Calls body(frame, source_pose, pose) for all frames, with the target's pose as given by
  // rotations and hips.
  template <typename Body>
  void for_frames(const Body& body) const {
    const auto frames = at(source_.frame_count());
    parallel_for(frames, kFramesATime, options_.jobs, [&](std::size_t begin, std::size_t end) {
      std::vector<Transform> source_pose(source_.skeleton.names.size());
      std::vector<Transform> pose(target_.names.size());
      for (std::size_t f = begin; f < end; ++f) {
        source_.get_pose(static_cast<int>(f), source_pose);
        pose_of(source_pose, pose);
        place(source_pose, pose);
        body(f, source_pose, pose);
      }
      if (options_.progress != nullptr) options_.progress->advance(end - begin);
    });
  }

  void lower(double by, std::span<Transform> pose) const {
    for (std::size_t k = 0; k < pose.size(); ++k) {
      if (below_anchor_[k] != 0) pose[k].position.y() -= by;
    }
  }

  // How far the hips are lowered in each frame so that planted feet reach the floor.
  std::vector<double> find_drops() const {
    std::vector<double> drops(at(source_.frame_count()), 0.0);
    for_frames([&](std::size_t f, std::span<const Transform> from, std::span<Transform> pose) {
      for (const Leg& leg : legs_) {
        drops[f] = std::max(drops[f], leg.placement.lack(from, pose, leg.standing[f]));
      }
    });
    const double most = 0.06 * leg_length(target_, target_roles_);
    for (double& drop : drops) drop = std::min(drop, most);
    if (std::all_of(drops.begin(), drops.end(), [](double drop) { return drop == 0; })) return {};
    return softened(drops, softening_reach(source_.rate));
  }

  Clip moved() {
    find_below_anchor();
    Clip clip;
    clip.skeleton = target_;
    clip.rate = source_.rate;
    const auto frames = at(source_.frame_count());
    clip.resize(source_.frame_count());
    if (options_.progress != nullptr) {
      options_.progress->begin("retargeting", (legs_.empty() ? 1 : 2) * frames);
    }
    const std::vector<double> drops = legs_.empty() ? std::vector<double>() : find_drops();
    std::vector<std::array<LegPlacement::Outcome, 2>> outcomes(frames);
    for_frames([&](std::size_t f, std::span<const Transform> from, std::span<Transform> pose) {
      if (!drops.empty()) lower(drops[f], pose);
      for (std::size_t i = 0; i < legs_.size(); ++i) {
        outcomes[f][i] = legs_[i].placement.place(from, local_, legs_[i].standing[f], pose);
      }
      clip.set_pose(static_cast<int>(f), pose);
    });
    if (options_.progress != nullptr) options_.progress->end();
    for (std::size_t i = 0; i < legs_.size(); ++i) {
      (legs_[i].is_left ? report_.left_foot : report_.right_foot) = summary(outcomes, i);
    }
    if (!drops.empty()) report_.largest_drop = *std::max_element(drops.begin(), drops.end());
    return clip;
  }

  static FootReport summary(const std::vector<std::array<LegPlacement::Outcome, 2>>& outcomes,
                            std::size_t side) {
    FootReport report;
    for (std::size_t f = 0; f < outcomes.size(); ++f) {
      const LegPlacement::Outcome& outcome = outcomes[f][side];
      if (outcome.correction > report.largest_correction) {
        report.largest_correction = outcome.correction;
        report.largest_correction_frame = static_cast<int>(f);
      }
      if (outcome.miss > report.largest_miss) {
        report.largest_miss = outcome.miss;
        report.largest_miss_frame = static_cast<int>(f);
      }
    }
    return report;
  }

  void note_joints() {
    std::vector<char> used(source_.skeleton.names.size(), 0);
    for (int k = 0; k < target_.joint_count(); ++k) {
      const JointSource& from = mapping_[at(k)];
      if (from.first < 0) {
        if (target_.end_sites[at(k)] == 0) report_.following_target.push_back(k);
        continue;
      }
      used[at(from.first)] = 1;
      if (from.second >= 0) used[at(from.second)] = 1;
      report_.mapped.push_back(
          {k, from.first, from.second, from.share, angle_between(Quat::Identity(), turns_[at(k)])});
    }
    for (std::size_t j = 0; j < used.size(); ++j) {
      if (used[j] == 0 && source_.skeleton.end_sites[j] == 0) {
        report_.unused_source.push_back(static_cast<int>(j));
      }
    }
  }

  const Clip& source_;
  const RoleMap& source_roles_;
  const Clip& target_clip_;
  const Skeleton& target_;
  const RoleMap& target_roles_;
  const Options& options_;

  std::vector<Transform> rest_;         // the source's reference pose, joint_to_world
  std::vector<Quat> rest_back_;         // its orientations, conjugated
  std::vector<Transform> target_rest_;  // that of the target
  JointMapping mapping_;                // [target joints]
  std::vector<Quat> turns_;             // [target joints], alignment of the reference pose
  std::vector<Transform> local_;        // [target joints], reference joint_to_parent
  std::vector<Quat> aligned_;  // [target joints], orientations of the aligned reference pose
  int anchor_ = 0;             // the target joint that carries the root motion
  std::vector<char> below_anchor_;
  std::array<int, 2> source_sides_ = {0, 0};  // joints whose midpoint is transferred
  std::array<int, 2> target_sides_ = {0, 0};
  double rise_ = 0;  // metres the target's hips are raised for the height of its ankles
  Floor source_floor_, target_floor_;
  struct Leg {
    LegPlacement placement;
    std::vector<double> standing;  // [frames]
    bool is_left = false;
  };
  std::vector<Leg> legs_;  // empty with Feet::free
  Report report_;
};

}  // namespace

Result<Retargeted> transfer(const Clip& source, const RoleMap& source_roles, const Clip& target,
                            const RoleMap& target_roles, const Options& options) {
  if (source.skeleton.empty()) return Error("retarget-empty", "the motion has no joints");
  if (target.skeleton.empty()) return Error("retarget-empty", "the target has no joints");
  if (options.scale && (!(*options.scale > 0) || !std::isfinite(*options.scale))) {
    return Error("retarget-scale",
                 fmt::format("a scale of {} is not positive and finite", *options.scale));
  }
  const auto same = same_skeleton(source.skeleton, target.skeleton);
  if (same && !options.source_frame && !options.target_frame &&
      (!options.scale || *options.scale == same->scale)) {
    return copy_of(source, target.skeleton, *same, same->scale);
  }
  return Transfer(source, source_roles, target, target_roles, options).run();
}

}  // namespace krok::retarget
