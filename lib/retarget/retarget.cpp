#include "retarget/retarget.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "contacts/contacts.h"
#include "core/index.h"
#include "math/quaternion.h"
#include "retarget/actor_view_internal.h"
#include "retarget/foot_placement.h"
#include "retarget/frame_transfer_internal.h"
#include "retarget/joint_mapping.h"
#include "retarget/pose_alignment.h"
#include "retarget/same_skeleton.h"
#include "retarget/stance.h"

namespace krok::retarget {

namespace {

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

// Finds how the skeletons correspond, then transfers the frames.
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
    rest_ = options_.source_pose.empty() ? source_stance->pose : options_.source_pose;
    target_rest_ = options_.target_pose.empty() ? target_stance->pose : options_.target_pose;
    report_.source_frame = source_stance->frame;
    report_.target_frame = target_stance->frame;
    report_.source_pose = rest_;
    report_.target_pose = target_rest_;
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
      plan_.local.push_back(target_.reference_local(k));
      plan_.aligned.push_back(turns_[at(k)] * target_rest_[at(k)].orientation);
    }
    for (const Transform& joint : rest_) plan_.rest_back.push_back(joint.orientation.conjugate());
    Retargeted result;
    plan_.scale = report_.scale;
    result.clip = transfer_frames(source_, target_, plan_, options_, report_);
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
    plan_.mapping = map_by_roles(source_.skeleton, source_roles_, target_, target_roles_,
                                 report_.left_fingers_at_rest, report_.right_fingers_at_rest);
    const Actor from{source_.skeleton, source_roles_, rest_};
    const Actor to{target_, target_roles_, target_rest_};
    turns_ = align_by_roles(from, to, plan_.mapping);
    report_.scale = options_.scale.value_or(leg_length(target_, target_roles_) /
                                            leg_length(source_.skeleton, source_roles_));
    take_anchor_of_roles();
    plan_.source_sides = {source_roles_.joint(Role::left_upper_leg),
                          source_roles_.joint(Role::right_upper_leg)};
    plan_.target_sides = {target_roles_.joint(Role::left_upper_leg),
                          target_roles_.joint(Role::right_upper_leg)};
    prepare_feet(from, to);
  }

  // The hips. Ancestors at the same position, as in Biped, rotate and move with them.
  void take_anchor_of_roles() {
    const int hips = target_roles_.joint(Role::hips);
    const double near = 0.05 * leg_length(target_, target_roles_);
    plan_.anchor = hips;
    for (int j = target_.parents[at(hips)]; j >= 0 && length_of(target_, j, hips) < near;
         j = target_.parents[at(j)]) {
      plan_.anchor = j;
      plan_.mapping[at(j)] = plan_.mapping[at(hips)];
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
      plan_.rise += 0.5 * (ankle_over_floor(to, foot, target_floor_) -
                           report_.scale * ankle_over_floor(from, foot, source_floor_));
    }
    plan_.leg_length = leg_length(target_, target_roles_);
    std::array<std::vector<double>, 2> stands;
    std::vector<Contact> contacts;
    std::array<std::optional<Vec3>, 2> heel_of_source;
    if (auto found = find_contacts(source_, source_roles_)) {
      contacts = std::move(found->contacts);
      for (const auto& [point, speed, height] : found->tracks) {
        if (point.part == FootPart::heel)
          heel_of_source[static_cast<std::size_t>(point.side)] = point.offset;
      }
    }
    std::array<std::optional<PointPair>, 2> heels;
    if (options_.feet == Feet::keep) stands = prepare_legs(from, to, contacts, heel_of_source);
    for (const PlacedLeg& leg : plan_.legs) heels[leg.is_left ? 0 : 1] = leg.placement.heel();
    if (options_.touches == Touches::free) return;
    plan_.touches.emplace(source_, from, to, report_.scale, source_floor_.motion,
                          leg_length(source_.skeleton, source_roles_), stands,
                          options_.feet == Feet::keep);
    plan_.touches->report_feet(contacts, from, to, source_floor_, target_floor_, source_.rate,
                               stands, heels);
  }

  // How much both feet stand, [2][frames], empty where a leg is missing.
  std::array<std::vector<double>, 2> prepare_legs(const Actor& from, const Actor& to,
                                                  std::span<const Contact> contacts,
                                                  std::span<const std::optional<Vec3>> heels) {
    std::array<std::vector<double>, 2> standing;
    for (const bool is_left : {true, false}) {
      auto leg = LegPlacement::create(from, to, turns_, report_.scale, source_floor_, target_floor_,
                                      is_left, heels[is_left ? 0 : 1]);
      if (!leg) continue;
      auto stances = leg->find_stances(source_, contacts);
      for (const FootStance& foot : stances.feet) {
        standing[is_left ? 0 : 1].push_back(foot.standing);
      }
      plan_.legs.push_back({std::move(*leg), std::move(stances), is_left});
    }
    return standing;
  }

  Status prepare_names() {
    report_.method = Method::names;
    plan_.mapping = map_by_names(source_.skeleton, target_);
    const auto shared =
        static_cast<int>(std::count_if(plan_.mapping.begin(), plan_.mapping.end(),
                                       [](const JointSource& entry) { return entry.first >= 0; }));
    const int fewer = std::min(joints_without_ends(source_.skeleton), joints_without_ends(target_));
    if (shared * 5 < fewer * 3 || shared == 0) {
      return Error(
          "retarget-roles",
          fmt::format("the skeletons are not both humanoid ({}), and share only {} of {} "
                      "joint names",
                      missing_text(source_roles_, target_roles_), shared, fewer),
          "assign joint roles with krok-retarget's --map and --onto-map; krok-info shows those "
          "found");
    }
    turns_ = align_by_names({source_.skeleton, source_roles_, rest_},
                            {target_, target_roles_, target_rest_}, plan_.mapping);
    report_.scale = options_.scale.value_or(bone_ratio(source_.skeleton, target_, plan_.mapping));
    plan_.anchor = first_mapped(plan_.mapping);
    plan_.source_sides = {plan_.mapping[at(plan_.anchor)].first,
                          plan_.mapping[at(plan_.anchor)].first};
    plan_.target_sides = {plan_.anchor, plan_.anchor};
    return {};
  }

  void note_joints() {
    const int hips = target_roles_.joint(Role::hips);
    const Quat hips_turn = hips < 0 ? Quat::Identity() : turns_[at(hips)];
    std::vector<char> used(source_.skeleton.names.size(), 0);
    for (int k = 0; k < target_.joint_count(); ++k) {
      const JointSource& from = plan_.mapping[at(k)];
      if (from.first < 0) {
        if (target_.end_sites[at(k)] == 0) report_.following_target.push_back(k);
        continue;
      }
      used[at(from.first)] = 1;
      if (from.second >= 0) used[at(from.second)] = 1;
      const Vec3 ahead = hips_turn.conjugate() * turns_[at(k)] * Vec3::UnitZ();
      report_.mapped.push_back({k, from.first, from.second, from.share,
                                angle_between(Quat::Identity(), turns_[at(k)]),
                                std::atan2(ahead.x(), ahead.z())});
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
  std::vector<Transform> target_rest_;  // that of the target
  std::vector<Quat> turns_;             // [target joints], alignment of the reference pose
  Floor source_floor_, target_floor_;
  TransferPlan plan_;
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
  auto same = same_skeleton(source.skeleton, target.skeleton);
  if (!same) same = same_body(source.skeleton, source_roles, target.skeleton, target_roles);
  const auto fits = [](const std::vector<Transform>& pose, const Skeleton& skeleton) {
    return pose.empty() || pose.size() == skeleton.names.size();
  };
  if (!fits(options.source_pose, source.skeleton) || !fits(options.target_pose, target.skeleton)) {
    return Error("retarget-pose", "a reference pose has another number of joints");
  }
  const bool given = options.source_frame || options.target_frame || !options.source_pose.empty() ||
                     !options.target_pose.empty();
  if (same && !given && (!options.scale || *options.scale == same->scale)) {
    auto copied = copy_of(source, target.skeleton, *same, same->scale);
    copied.report.source_pose = source.skeleton.reference;
    copied.report.target_pose = target.skeleton.reference;
    return copied;
  }
  return Transfer(source, source_roles, target, target_roles, options).run();
}

}  // namespace krok::retarget
