#include "retarget/retarget.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <utility>

#include "contacts/long_take.h"
#include "contacts/sole_points.h"
#include "core/index.h"
#include "math/quaternion.h"
#include "retarget/actor_view_internal.h"
#include "retarget/copied_frames_internal.h"
#include "retarget/foot_placement.h"
#include "retarget/frame_transfer_internal.h"
#include "retarget/joint_mapping.h"
#include "retarget/pose_alignment.h"
#include "retarget/same_skeleton.h"
#include "retarget/stance.h"

namespace krok::retarget {

namespace {

// Seconds before and after a block that its result depends on: a touch fades for 0.3 s, and four
// times values are smoothed over 0.12 s on either side.
constexpr double kOverlap = 2;
constexpr int kSamples = 8, kOfSample = 2048;  // frames

// All of a short take, eight parts of a longer one.
Result<Clip> sample_of(const FrameSource& source, int jobs) {
  if (source.frame_count <= kSamples * kOfSample) return load(source, jobs);
  Clip sample;
  sample.skeleton = source.skeleton;
  sample.rate = source.rate;
  for (int i = 0; i < kSamples; ++i) {
    const int first = (source.frame_count - kOfSample) / (kSamples - 1) * i;
    const auto part = load(part_of(source, first, kOfSample), jobs);
    if (!part) return part.error();
    sample.positions.insert(sample.positions.end(), part->positions.begin(), part->positions.end());
    sample.orientations.insert(sample.orientations.end(), part->orientations.begin(),
                               part->orientations.end());
  }
  return sample;
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

// The joint of a hand or head and those of its fingers and ends: what it holds or wears is not
// counted.
std::vector<int> with_its_parts(const Skeleton& skeleton, const RoleMap& roles, int joint) {
  std::vector<int> parts;
  for (const int j : joints_below(skeleton, joint)) {
    const Role role = roles.roles[at(j)];
    const bool is_part =
        skeleton.end_sites[at(j)] != 0 || (role != Role::none && role != Role::helper);
    if (j == joint || (is_part && std::ranges::count(parts, skeleton.parents[at(j)]) > 0)) {
      parts.push_back(j);
    }
  }
  return parts;
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
  Transfer(const FrameSource& source, const RoleMap& source_roles, const Clip& target,
           const RoleMap& target_roles, const Options& options, int block_frames)
      : source_(source),
        source_roles_(source_roles),
        target_clip_(target),
        target_(target.skeleton),
        target_roles_(target_roles),
        options_(options),
        size_{std::max(block_frames, 1), static_cast<int>(std::ceil(kOverlap * source.rate))} {}

  // The frames keep `self`, which is this.
  Result<RetargetedFrames> run(const std::shared_ptr<Transfer>& self) {
    if (options_.progress != nullptr && source_.frame_count > 0) {
      options_.progress->begin("retargeting", 2 * at(source_.frame_count));
    }
    const bool by_roles = source_roles_.humanoid && target_roles_.humanoid;
    const auto sample = sample_of(source_, options_.jobs);
    if (!sample) return sample.error();
    auto source_stance = options_.source_frame ? stance_of_frame(source_, *options_.source_frame)
                                               : find_stance(*sample, source_roles_, {});
    if (!source_stance) return source_stance.error();
    auto target_stance = find_stance(target_clip_, target_roles_, options_.target_frame);
    if (!target_stance) return target_stance.error();
    rest_ = options_.source_pose.empty() ? source_stance->pose : options_.source_pose;
    target_rest_ = options_.target_pose.empty() ? target_stance->pose : options_.target_pose;
    report_->source_frame = source_stance->frame;
    report_->target_frame = target_stance->frame;
    report_->source_pose = rest_;
    report_->target_pose = target_rest_;
    const krok::Feet feet = by_roles ? find_feet(*sample, source_roles_) : krok::Feet();
    if (Status status = by_roles ? prepare_roles(feet) : prepare_names(); !status) {
      return status.error();
    }
    if (!(report_->scale > 0) || !std::isfinite(report_->scale)) {
      return Error("retarget-scale", "cannot compute a scale from the lengths of the skeletons",
                   "set it with --scale");
    }
    for (int k = 0; k < target_.joint_count(); ++k) {
      plan_.local.push_back(target_.reference_local(k));
      plan_.aligned.push_back(turns_[at(k)] * target_rest_[at(k)].orientation);
    }
    take_face_from_motion();
    take_hip_joints_from_motion();
    for (const Transform& joint : rest_) plan_.rest_back.push_back(joint.orientation.conjugate());
    plan_.scale = report_->path_scale = report_->scale;
    if (!by_roles) {
      keep_lowest_on_ground();
    } else if (Status status = prepare_feet(feet); !status) {
      return status.error();
    }
    note_joints();
    RetargetedFrames result{
        changed_in_blocks(source_, size_, options_.jobs,
                          [self](FrameRun& frames) { return self->transfer(frames); }),
        report_};
    result.frames.skeleton = target_;
    result.measure_contacts = [self](const FrameSource& laid, const GroundHeight& ground) {
      return self->measure_contacts(laid, ground);
    };
    return result;
  }

 private:
  Actor from() const { return {source_.skeleton, source_roles_, rest_}; }
  Actor onto() const { return {target_, target_roles_, target_rest_}; }

  void take_face_from_motion() {
    for (const int joint : faces_of_motion(target_clip_, target_roles_)) {
      if (plan_.mapping[at(joint)].first >= 0) continue;
      plan_.local[at(joint)].orientation = turn_in_frame(target_clip_, joint, 0);
    }
  }

  // Joints between hips and thighs that captures of CMU keep turned by 10 degrees from the
  // reference pose: thighs are below the hips as in the target's motion.
  void take_hip_joints_from_motion() {
    const int frames = target_clip_.frame_count();
    const int hips = target_roles_.joint(Role::hips);
    for (const LegRoles& leg : kLegRoles) {
      int joint = target_roles_.joint(leg.upper);
      if (frames == 0 || joint < 0 || hips < 0 || !carries(target_, hips, joint)) continue;
      for (joint = target_.parents[at(joint)]; joint != hips; joint = target_.parents[at(joint)]) {
        if (plan_.mapping[at(joint)].first >= 0) continue;
        const Quat first = turn_in_frame(target_clip_, joint, 0);
        Vec3 mean = Vec3::Zero();
        for (int f = 0; f < frames; ++f) {
          mean += rotation_vector(first.conjugate() * turn_in_frame(target_clip_, joint, f));
        }
        plan_.local[at(joint)].orientation =
            (first * from_rotation_vector(mean / frames)).normalized();
      }
    }
  }

  void advance(const FrameRun& frames) const {
    if (options_.progress == nullptr) return;
    options_.progress->advance(static_cast<std::uint64_t>(frames.kept_end - frames.kept_begin));
  }

  // What the source touches in some frames of it, or none if that does not matter.
  std::optional<TouchKeeping> find_touches(const FrameRun& frames, bool again) const {
    if (report_->method != Method::roles || options_.touches == Touches::free) return {};
    TouchKeeping touches(frames.clip, from(), onto(), plan_.scale, source_floor_.motion,
                         leg_length(source_.skeleton, source_roles_), options_.feet == Feet::keep);
    note_touches(frames, target_, plan_, options_.jobs, again, touches);
    return touches;
  }

  // Those of `found`, as the whole take has them.
  void settle(const FrameRun& frames, std::optional<TouchKeeping>& found) const {
    if (!found) return;
    found->settle(plan_.stays, stances(), frames.first);
    found->find_on_body(frames.clip, from(), onto(), leg_length(source_.skeleton, source_roles_));
  }

  Status measure_contacts(const FrameSource& laid, const GroundHeight& ground) {
    report_->path_scale = 1;
    report_->contacts.clear();
    return for_each_run(source_, size_, options_.jobs, [&](const FrameRun& run) -> Status {
      auto touches = find_touches(run, true);
      if (!touches) return {};
      settle(run, touches);
      const auto made = load(part_of(laid, run.first, run.clip.frame_count()), options_.jobs);
      if (!made) return made.error();
      add_contacts(touches->report(run, plan_.kept, *made, ground), report_->contacts);
      return {};
    });
  }

  Status transfer(FrameRun& frames) {
    auto touches = touches_ ? std::exchange(touches_, {}) : find_touches(frames, true);
    settle(frames, touches);
    const int end = frames.first + frames.kept_end;
    const bool again = end <= reported_;
    Report of_before;
    if (again) of_before = *report_;
    frames.clip =
        transfer_frames(frames, target_, plan_, options_.jobs, touches ? &*touches : nullptr,
                        poses_, again ? of_before : *report_);
    if (again) return {};
    reported_ = end;
    advance(frames);
    if (options_.progress != nullptr && end == source_.frame_count) options_.progress->end();
    return {};
  }

  StancesOfFeet stances() const {
    StancesOfFeet feet;
    for (const PlacedLeg& leg : plan_.legs) feet[leg.is_left ? 0 : 1] = leg.stances.feet;
    return feet;
  }

  // Of the source, in the ankles' frames.
  static std::array<std::optional<Vec3>, 2> heels_of(const krok::Feet& feet) {
    std::array<std::optional<Vec3>, 2> heels;
    for (std::size_t side = 0; side < 2; ++side) {
      for (const SolePoint& point : feet.points[side]) {
        if (point.part == FootPart::heel) heels[side] = point.offset;
      }
    }
    return heels;
  }

  Status prepare_roles(const krok::Feet& feet) {
    report_->method = Method::roles;
    bool& left_rests = report_->left_fingers_at_rest = true;
    bool& right_rests = report_->right_fingers_at_rest = true;
    Status status = for_each_block(source_, options_.jobs, [&](int, const Clip& block) {
      left_rests = left_rests && fingers_never_move(block, source_roles_, rest_, Role::left_hand,
                                                    Role::left_fingers);
      right_rests = right_rests && fingers_never_move(block, source_roles_, rest_, Role::right_hand,
                                                      Role::right_fingers);
      add_lowest(block, from(), lowest_);
      return Status();
    });
    if (!status) return status;
    plan_.mapping = map_by_roles(source_.skeleton, source_roles_, target_, target_roles_,
                                 left_rests, right_rests);
    turns_ = align_by_roles(from(), onto(), plan_.mapping, heels_of(feet));
    report_->scale = options_.scale.value_or(leg_length(target_, target_roles_) /
                                             leg_length(source_.skeleton, source_roles_));
    take_anchor_of_roles();
    plan_.source_sides = {source_roles_.joint(Role::left_upper_leg),
                          source_roles_.joint(Role::right_upper_leg)};
    plan_.target_sides = {target_roles_.joint(Role::left_upper_leg),
                          target_roles_.joint(Role::right_upper_leg)};
    return {};
  }

  // The hips. Ancestors at the same position, as in Biped, rotate and move with them.
  void take_anchor_of_roles() {
    const int hips = target_roles_.joint(Role::hips);
    const double near = kAtHips * leg_length(target_, target_roles_);
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
    LowestOfFeet lowest;
    add_lowest(target_clip_, to, lowest);
    const double leg = leg_length(target_, target_roles_);
    const double sole = standing_height(std::move(lowest)).lower;
    return is_sole(sole, leg) ? std::optional(sole) : std::nullopt;
  }

  // Whether foot joints at this height in stance have soles on a floor at 0.
  static bool is_sole(double height, double leg) {
    return height > -0.02 * leg && height < 0.08 * leg;
  }

  // By how much each of the source's legs is shorter than the other, beyond what the target's is:
  // so much higher its foot stands, on level ground. Captures have such legs (2 %), which bent the
  // knees of even ones by 20 degrees.
  std::array<double, 2> shorter_by() const {
    const auto right_over_left = [](const Skeleton& skeleton, const RoleMap& roles) {
      double longer = 0;
      for (const LegRoles& leg : kLegRoles) {
        const int hip = roles.joint(leg.upper), knee = roles.joint(leg.lower);
        const double length =
            length_of(skeleton, hip, knee) + length_of(skeleton, knee, roles.joint(leg.foot));
        longer = length - longer;
      }
      return longer;
    };
    const double uneven = right_over_left(source_.skeleton, source_roles_) -
                          right_over_left(target_, target_roles_) / report_->scale;
    return {std::max(0.0, uneven), std::max(0.0, -uneven)};
  }

  Status prepare_feet(const krok::Feet& feet) {
    const double leg = leg_length(source_.skeleton, source_roles_);
    const StandingHeight standing = standing_height(std::exchange(lowest_, {}));
    const auto sole = target_sole(onto());
    const bool has_soles = sole && is_sole(standing.lower, leg);
    const auto floor_at = [&](double height) {
      return has_soles ? Floor{height, 0} : Floor{0, height};
    };
    source_floor_ = floor_at(standing.lower);
    const auto uneven = shorter_by();
    for (std::size_t side = 0; side < 2; ++side) {
      const double higher = standing.of_foot[side] - standing.lower;
      floors_of_feet_[side] = floor_at(standing.lower + std::clamp(higher, 0.0, uneven[side]));
    }
    if (has_soles) target_floor_.sole = *sole;
    target_floor_.motion = report_->scale * source_floor_.motion;
    report_->floor = plan_.floor = target_floor_.motion;
    plan_.source_floor = source_floor_.motion;
    for (const Role role : {Role::left_hand, Role::right_hand, Role::head}) {
      const int of_source = source_roles_.joint(role), of_target = target_roles_.joint(role);
      if (of_source < 0 || of_target < 0) continue;
      plan_.above_floor.push_back({with_its_parts(source_.skeleton, source_roles_, of_source),
                                   with_its_parts(target_, target_roles_, of_target)});
    }
    for (const Role foot : {Role::left_foot, Role::right_foot}) {
      plan_.rise += 0.5 * (ankle_over_floor(onto(), foot, target_floor_) -
                           report_->scale * ankle_over_floor(from(), foot, source_floor_));
    }
    plan_.leg_length = leg_length(target_, target_roles_);
    std::vector<Contact> contacts;
    auto found =
        find_in_long_take(source_, source_roles_, options_.jobs, nullptr, {.contacts_alone = true});
    if (!found && found.error().code != "contacts-feet") return found.error();
    if (found) contacts = std::move(found->keys.contacts);
    if (options_.feet == Feet::keep) add_legs(feet);
    return find_stances(contacts);
  }

  void add_legs(const krok::Feet& feet) {
    const std::vector<BodyPoint> source_points = estimated_tips(feet);
    const std::vector<BodyPoint> target_points =
        options_.target_feet.empty() ? estimated_tips(find_feet(target_clip_, target_roles_))
                                     : options_.target_feet;
    const auto heels = heels_of(feet);
    for (const bool is_left : {true, false}) {
      auto leg = LegPlacement::create(from(), onto(), turns_, report_->scale,
                                      floors_of_feet_[is_left ? 0 : 1], target_floor_, is_left,
                                      heels[is_left ? 0 : 1], source_points, target_points);
      if (!leg) continue;
      (is_left ? report_->left_foot : report_->right_foot).emplace();
      plan_.legs.push_back({std::move(*leg), {}, is_left});
    }
  }

  // How feet stand, and what the body touches on the ground, over the whole take.
  Status find_stances(std::span<const Contact> contacts) {
    std::vector<LegPlacement::Track> tracks;
    for (const PlacedLeg& leg : plan_.legs) {
      tracks.push_back(leg.placement.begin_track(contacts, source_.frame_count, source_.rate));
    }
    const auto look = [&](const FrameRun& frames) {
      for (std::size_t i = 0; i < tracks.size(); ++i) {
        plan_.legs[i].placement.add(frames.clip, frames.kept_begin, frames.kept_end, tracks[i]);
      }
      touches_ = find_touches(frames, false);
      if (touches_) touches_->add_stays(frames, plan_.stays);
      if (source_.frame_count > size_.frames) touches_.reset();
      advance(frames);
      return Status();
    };
    if (Status status = for_each_run(source_, size_, options_.jobs, look); !status) return status;
    std::array<std::optional<PointPair>, 2> heels;
    for (std::size_t i = 0; i < tracks.size(); ++i) {
      PlacedLeg& leg = plan_.legs[i];
      leg.stances = leg.placement.find_stances(std::move(tracks[i]), source_.rate);
      heels[leg.is_left ? 0 : 1] = leg.placement.heel();
    }
    if (options_.touches == Touches::free) return {};
    plan_.kept = kept_contacts(contacts, from(), onto(), plan_.scale, floors_of_feet_,
                               target_floor_, source_.rate, stances(), heels);
    return {};
  }

  // The first mapped joint, or the first below it at which the skeleton branches.
  int first_of_body() const {
    const int first = first_mapped(plan_.mapping);
    const auto children = target_.children();
    int joint = first;
    while (children[at(joint)].size() == 1) {
      joint = children[at(joint)].front();
      if (plan_.mapping[at(joint)].first < 0) return first;
    }
    return children[at(joint)].empty() ? first : joint;
  }

  Status prepare_names() {
    report_->method = Method::names;
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
    report_->scale = options_.scale.value_or(bone_ratio(source_.skeleton, target_, plan_.mapping));
    // The hips carry the travel; a root above them may stay where it is.
    const int hips = target_roles_.joint(Role::hips), of_source = source_roles_.joint(Role::hips);
    const bool by_hips = hips >= 0 && of_source >= 0 && plan_.mapping[at(hips)].first == of_source;
    plan_.anchor = by_hips ? hips : first_of_body();
    plan_.source_sides = {plan_.mapping[at(plan_.anchor)].first,
                          plan_.mapping[at(plan_.anchor)].first};
    plan_.target_sides = {plan_.anchor, plan_.anchor};
    return {};
  }

  // Animals whose legs are shorter than their bones as a whole do not hang in the air by the legs
  // of the source: in the reference pose the lowest mapped joints of both are equally high.
  void keep_lowest_on_ground() {
    std::vector<Transform> pose(target_rest_);
    double lowest = 0, source_lowest = 0;  // above the anchor, metres
    for (int k = 0; k < target_.joint_count(); ++k) {
      const int parent = target_.parents[at(k)], from = plan_.mapping[at(k)].first;
      if (parent >= 0) pose[at(k)] = pose[at(parent)] * plan_.local[at(k)];
      if (from < 0) continue;
      pose[at(k)].orientation = plan_.aligned[at(k)];
      if (!carries(target_, plan_.anchor, k)) continue;
      const auto above = [](const Transform& joint, const Transform& anchor) {
        return joint.position.y() - anchor.position.y();
      };
      lowest = std::min(lowest, above(pose[at(k)], pose[at(plan_.anchor)]));
      source_lowest =
          std::min(source_lowest, above(rest_[at(from)], rest_[at(plan_.source_sides[0])]));
    }
    plan_.rise = plan_.scale * source_lowest - lowest;
    plan_.leg_length = -lowest;
  }

  void note_joints() {
    const int hips = target_roles_.joint(Role::hips);
    const Quat hips_turn = hips < 0 ? Quat::Identity() : turns_[at(hips)];
    std::vector<char> used(source_.skeleton.names.size(), 0);
    for (int k = 0; k < target_.joint_count(); ++k) {
      const JointSource& from = plan_.mapping[at(k)];
      if (from.first < 0) {
        if (target_.end_sites[at(k)] == 0) report_->following_target.push_back(k);
        continue;
      }
      used[at(from.first)] = 1;
      if (from.second >= 0) used[at(from.second)] = 1;
      const Vec3 ahead = hips_turn.conjugate() * turns_[at(k)] * Vec3::UnitZ();
      report_->mapped.push_back({k, from.first, from.second, from.share,
                                 angle_between(Quat::Identity(), turns_[at(k)]),
                                 std::atan2(ahead.x(), ahead.z())});
    }
    for (std::size_t j = 0; j < used.size(); ++j) {
      if (used[j] == 0 && source_.skeleton.end_sites[j] == 0) {
        report_->unused_source.push_back(static_cast<int>(j));
      }
    }
  }

  const FrameSource source_;
  const RoleMap& source_roles_;
  const Clip& target_clip_;
  const Skeleton& target_;
  const RoleMap& target_roles_;
  const Options options_;
  const BlockSize size_;

  std::vector<Transform> rest_;         // the source's reference pose, joint_to_world
  std::vector<Transform> target_rest_;  // that of the target
  std::vector<Quat> turns_;             // [target joints], alignment of the reference pose
  LowestOfFeet lowest_;                 // of add_lowest(), until the floor is known
  Floor source_floor_, target_floor_;
  std::array<Floor, 2> floors_of_feet_;  // the source's, of left and right: see StandingHeight
  std::optional<TouchKeeping> touches_;  // those of a take that is one block
  TransferPlan plan_;
  std::vector<Transform> poses_;
  std::shared_ptr<Report> report_ = std::make_shared<Report>();
  int reported_ = 0;  // frames that report_ is of
};

}  // namespace

Result<Retargeted> transfer(const Clip& source, const RoleMap& source_roles, const Clip& target,
                            const RoleMap& target_roles, const Options& options) {
  auto made = transfer(frames_of(source), source_roles, target, target_roles, options);
  if (!made) return made.error();
  auto clip = load(made->frames, options.jobs);
  if (!clip) return clip.error();
  return Retargeted{*std::move(clip), std::move(*made->report)};
}

Result<RetargetedFrames> transfer(const FrameSource& source, const RoleMap& source_roles,
                                  const Clip& target, const RoleMap& target_roles,
                                  const Options& options, int block_frames) {
  if (source.skeleton.empty()) return Error("retarget-empty", "the motion has no joints");
  if (target.skeleton.empty()) return Error("retarget-empty", "the target has no joints");
  if (options.scale && (!(*options.scale > 0) || !std::isfinite(*options.scale))) {
    return Error("retarget-scale",
                 fmt::format("a scale of {} is not positive and finite", *options.scale));
  }
  auto same = same_skeleton(source.skeleton, target.skeleton);
  if (!same) same = same_body(source.skeleton, source_roles, target.skeleton, target_roles);
  if (!same) same = same_person(source.skeleton, source_roles, target.skeleton, target_roles);
  const auto fits = [](const std::vector<Transform>& pose, const Skeleton& skeleton) {
    return pose.empty() || pose.size() == skeleton.names.size();
  };
  if (!fits(options.source_pose, source.skeleton) || !fits(options.target_pose, target.skeleton)) {
    return Error("retarget-pose", "a reference pose has another number of joints");
  }
  const bool given = options.source_frame || options.target_frame || !options.source_pose.empty() ||
                     !options.target_pose.empty();
  if (same && !given && (!options.scale || *options.scale == same->scale)) {
    return copied_frames(source, target, target_roles, *same);
  }
  const auto made =
      std::make_shared<Transfer>(source, source_roles, target, target_roles, options, block_frames);
  return made->run(made);
}

}  // namespace krok::retarget
