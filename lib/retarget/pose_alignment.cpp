#include "retarget/pose_alignment.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "core/index.h"
#include "math/quaternion.h"
#include "retarget/actor_view_internal.h"

namespace krok::retarget {

namespace {

// Of what a leg is more to the side, how far the sole may be tilted.
constexpr double kMaxTilt = 1.3;

double degrees(double angle) {
  return angle * kRadiansPerDegree;
}

// The unit part of v perpendicular to the unit vector `axis`; empty if there is none.
std::optional<Vec3> across(const Vec3& v, const Vec3& axis) {
  const Vec3 part = v - axis * axis.dot(v);
  const double length = part.norm();
  if (!(length > 1e-6 * v.norm()) || !(length > 0)) return std::nullopt;
  return Vec3(part / length);
}

// The rotation that maps unit `x` to `x_to` and, as far as possible, `y` to `y_to`.
Quat frame_turn(const Vec3& x, const Vec3& y, const Vec3& x_to, const Vec3& y_to) {
  const auto from = across(y, x);
  const auto to = across(y_to, x_to);
  if (!from || !to) return shortest_arc(x, x_to);
  Mat3 before, after;
  before << x, *from, x.cross(*from);
  after << x_to, *to, x_to.cross(*to);
  return normalized_or_identity(Quat(Mat3(after * before.transpose())));
}

// The smallest rotation of direction `from` to `to`. Nearly opposite directions are first rotated
// by half a turn about `axis`, because their smallest rotation is ill-defined.
Quat swing(const Vec3& from, const Vec3& to, const Vec3& axis) {
  if (from.normalized().dot(to.normalized()) > std::cos(degrees(150))) {
    return shortest_arc(from, to);
  }
  const auto square = across(axis, from.normalized());
  if (!square) return shortest_arc(from, to);
  const Quat half = from_rotation_vector(kPi * *square);
  return shortest_arc(half * from, to) * half;
}

class Aligner {
 public:
  Aligner(const Actor& source, const Actor& target, const JointMapping& mapping,
          const std::array<std::optional<Vec3>, 2>& heels)
      : source_(source), target_(target), mapping_(mapping), heels_(heels), turns_(mapping.size()) {
    set_.assign(mapping.size(), 0);
  }

  std::vector<Quat> align() {
    hips_ = trunk_turn(Role::left_upper_leg, Role::right_upper_leg, source_.hips_up(),
                       target_.hips_up());
    standing_ = standing_turn();
    chest_ = trunk_turn(Role::left_upper_arm, Role::right_upper_arm, source_.chest_up(),
                        target_.chest_up());
    set(target_.joint(Role::hips), hips_);
    for (std::size_t k = 0; k < mapping_.size(); ++k) {
      if (mapping_[k].along > 0) set(static_cast<int>(k), slerp(hips_, chest_, mapping_[k].along));
    }
    for (const Role role : {Role::chest, Role::head}) set(target_.joint(role), chest_);
    for (const int neck : target_.roles().joints(Role::neck)) set(neck, chest_);
    for (const ArmRoles& arm : kArmRoles) align_arm(arm);
    for (const LegRoles& leg : kLegRoles) align_leg(leg);
    hand_down();
    return std::move(turns_);
  }

 private:
  void set(int joint, const Quat& turn) {
    if (joint < 0) return;
    turns_[at(joint)] = turn;
    set_[at(joint)] = 1;
  }

  // Aligns left, then up as far as the difference is a bend and not body build.
  Quat trunk_turn(Role left, Role right, const std::optional<Vec3>& source_up,
                  const std::optional<Vec3>& target_up) const {
    const auto from = target_.left(left, right);
    const auto to = source_.left(left, right);
    if (!from || !to) return Quat::Identity();
    if (lies_on_side(*from, *to) && source_up && target_up)
      return frame_turn(*from, *target_up, *to, *source_up);
    const Quat level = frame_turn(*from, kUp, *to, kUp);
    if (!source_up || !target_up) return level;
    const auto now = across(level * *target_up, *to);
    const auto wanted = across(*source_up, *to);
    if (!now || !wanted) return level;
    const double lean = std::atan2(now->cross(*wanted).dot(*to), now->dot(*wanted));
    const double taken = lean * smooth_step(degrees(15), degrees(35), std::abs(lean));
    return from_rotation_vector(taken * *to) * level;
  }

  static bool lies_on_side(const Vec3& from, const Vec3& to) {
    return std::abs(from.dot(kUp)) > 0.9 || std::abs(to.dot(kUp)) > 0.9;
  }

  // The turn of the hips as far as the legs lean as the trunk does: of a body that leans as a whole
  // and not of one that stoops over upright legs, whose soles are flat.
  Quat standing_turn() const {
    const auto from = target_.left(Role::left_upper_leg, Role::right_upper_leg);
    const auto to = source_.left(Role::left_upper_leg, Role::right_upper_leg);
    const auto source_up = source_.legs_up(), target_up = target_.legs_up();
    if (!from || !to || !source_up || !target_up || lies_on_side(*from, *to)) return hips_;
    const Quat level = frame_turn(*from, kUp, *to, kUp);
    const Vec3 hips = rotation_vector(hips_ * level.conjugate());
    const auto now = across(level * *target_up, *to), wanted = across(*source_up, *to);
    const bool stoops = hips.norm() > 1e-6 && hips.norm() < degrees(90);
    if (!now || !wanted || !stoops) return hips_;
    const double lean = std::atan2(now->cross(*wanted).dot(*to), now->dot(*wanted));
    const double share = smooth_step(0.25, 0.75, lean * to->dot(hips) / hips.squaredNorm());
    return share < 1 ? slerp(level, hips_, share) : hips_;
  }

  // Rotates joint `upper` so that its bone to `lower` points as the source's.
  Quat bone_turn(const Quat& above, Role upper, Role lower, const Vec3& axis) {
    return bone_turn(above, source_.direction(source_.joint(upper), source_.joint(lower)),
                     target_.direction(target_.joint(upper), target_.joint(lower)), axis);
  }

  static Quat bone_turn(const Quat& above, const std::optional<Vec3>& to,
                        const std::optional<Vec3>& from, const Vec3& axis) {
    if (!from || !to) return above;
    return swing(above * *from, *to, axis) * above;
  }

  void align_arm(const ArmRoles& arm) {
    const Vec3 forward = source_forward(Role::left_upper_arm, Role::right_upper_arm);
    const bool elbow = source_.joint(arm.lower) >= 0 && target_.joint(arm.lower) >= 0;
    const Role end = elbow ? arm.lower : arm.hand;
    const Quat collar = collar_turn(arm, end, forward);
    set(target_.joint(arm.collar), collar);
    const Quat upper = bone_turn(collar, arm.upper, end, forward);
    set(target_.joint(arm.upper), upper);
    Quat lower = elbow ? bone_turn(upper, arm.lower, arm.hand, forward) : upper;
    const Quat straight = straight_hand(arm, lower, forward);
    const double twist = palm_twist(arm, straight);
    const auto forearm = source_.direction(source_.joint(arm.lower), source_.joint(arm.hand));
    const auto along = source_.hand_direction(arm) ? source_.hand_direction(arm) : forearm;
    const Quat hand = along ? from_rotation_vector(twist * *along) * straight : straight;
    // The palm turns by the twist of the forearm, so the forearm gets half of it.
    if (elbow && forearm) lower = from_rotation_vector(0.5 * twist * *forearm) * lower;
    set(target_.joint(arm.lower), lower);
    const int wrist = target_.joint(arm.hand);
    set(wrist, wrist >= 0 && mapping_[at(wrist)].twists ? lower : hand);
    const int palm = palm_joint(target_.skeleton(), target_.roles(), arm.hand);
    set(palm, hand);
    align_fingers(arm, hand, palm, forward);
  }

  // Collars rise with raised arms: one is turned to the source's as far as both differ by more than
  // build does and the arm is turned the same way. Without the source's: to straight aside.
  Quat collar_turn(const ArmRoles& arm, Role end, const Vec3& forward) {
    const auto from = target_.direction(target_.joint(arm.collar), target_.joint(arm.upper));
    auto to = source_.direction(source_.joint(arm.collar), source_.joint(arm.upper));
    if (!to) {
      const bool is_left = arm.upper == Role::left_upper_arm;
      to = is_left ? source_.left(Role::left_upper_arm, Role::right_upper_arm)
                   : source_.left(Role::right_upper_arm, Role::left_upper_arm);
    }
    if (!from || !to) return chest_;
    const Vec3 turn = rotation_vector(swing(chest_ * *from, *to, forward));
    const Vec3 of_arm =
        rotation_vector(bone_turn(chest_, arm.upper, end, forward) * chest_.conjugate());
    const double alike = of_arm.dot(turn.stableNormalized());
    const double share = smooth_step(degrees(30), degrees(50), turn.norm()) *
                         smooth_step(degrees(30), degrees(50), alike);
    return from_rotation_vector(share * turn) * chest_;
  }

  Vec3 source_forward(Role left, Role right) const {
    const auto side = source_.left(left, right);
    if (!side) return Vec3::UnitZ();
    return across(side->cross(kUp), kUp).value_or(Vec3::UnitZ());
  }

  Quat straight_hand(const ArmRoles& arm, const Quat& lower, const Vec3& axis) const {
    const auto from = target_.hand_direction(arm);
    const auto to = source_.hand_direction(arm);
    return from && to ? swing(lower * *from, *to, axis) * lower : lower;
  }

  // The angle about the hand's direction that makes the palm face as the source's.
  double palm_twist(const ArmRoles& arm, const Quat& straight) const {
    auto from = target_.knuckle_line(arm);
    auto to = source_.knuckle_line(arm);
    if (!from || !to) {
      from = target_.thumb_line(arm);
      to = source_.thumb_line(arm);
    }
    auto along = source_.hand_direction(arm);
    if (!along) along = source_.direction(source_.joint(arm.lower), source_.joint(arm.hand));
    if (!from || !to || !along) return 0;
    const auto now = across(straight * *from, *along);
    const auto wanted = across(*to, *along);
    if (!now || !wanted) return 0;
    return std::atan2(now->cross(*wanted).dot(*along), now->dot(*wanted));
  }

  void align_fingers(const ArmRoles& arm, const Quat& hand, int palm, const Vec3& axis) {
    for (const int joint : target_.roles().joints(arm.fingers)) {
      const int from = mapping_[at(joint)].first;
      if (joint == palm) continue;
      const int parent = target_.skeleton().parents[at(joint)];
      const Quat above = set_[at(parent)] != 0 ? turns_[at(parent)] : hand;
      if (from < 0) {
        set(joint, above);
        continue;
      }
      const int next_source = source_.only_child(from);
      const int next_target = target_.only_child(joint);
      set(joint, bone_turn(above, source_.direction(from, next_source),
                           target_.direction(joint, next_target), axis));
    }
  }

  void align_leg(const LegRoles& leg) {
    const Vec3 side =
        source_.left(Role::left_upper_leg, Role::right_upper_leg).value_or(Vec3::UnitX());
    const Quat upper = bone_turn(hips_, leg.upper, leg.lower, side);
    const Quat lower = bone_turn(upper, leg.lower, leg.foot, side);
    const Quat foot = foot_turn(leg, side);
    set(target_.joint(leg.upper), upper);
    set(target_.joint(leg.lower), lower);
    set(target_.joint(leg.foot), foot);
    for (const int toe : first_toes(target_.skeleton(), target_.roles(), leg.foot)) set(toe, foot);
  }

  Quat foot_turn(const LegRoles& leg, const Vec3& side) const {
    const int from_foot = target_.joint(leg.foot);
    const int to_foot = source_.joint(leg.foot);
    const auto from =
        target_.direction(from_foot, foot_front(target_.skeleton(), target_.roles(), leg.foot));
    const auto to =
        source_.direction(to_foot, foot_front(source_.skeleton(), source_.roles(), leg.foot));
    if (!from || !to) return standing_;
    const Vec3 now = standing_ * *from;
    const Vec3 flat_now = now - now.dot(kUp) * kUp;
    const Vec3 flat_to = *to - to->dot(kUp) * kUp;
    if (flat_now.norm() < 0.25 || flat_to.norm() < 0.25) return standing_;
    const double yaw = std::atan2(flat_now.cross(flat_to).dot(kUp), flat_now.dot(flat_to));
    if (std::abs(yaw) > degrees(90)) return standing_;
    // A foot pitched that much more than the other is not flat on the floor, unless the other is
    // level: rigs have ankles as low as the toes.
    const double pitch_to = std::asin(std::clamp(to->dot(kUp), -1.0, 1.0));
    const double pitch_now = std::asin(std::clamp(now.dot(kUp), -1.0, 1.0));
    const auto [level, steep] = std::minmax({std::abs(pitch_to), std::abs(pitch_now)});
    const double pitch = pitch_to - pitch_now;
    const double taken = pitch * smooth_step(degrees(30), degrees(50), std::abs(pitch)) *
                         std::max(smooth_step(degrees(5), degrees(15), level),
                                  smooth_step(degrees(60), degrees(70), steep));
    const Vec3 hinge = across(side, flat_to.normalized()).value_or(side);
    return tilt_of_sole(leg, *to) * from_rotation_vector(-taken * hinge) *
           from_rotation_vector(yaw * kUp) * standing_;
  }

  // The turn of a foot whose sole is flat, and that heads as the source's does in its reference
  // pose, to that of the source's, as far as its leg is more to the side there than the target's:
  // 14 degrees inwards it would head otherwise, of captures with legs spread by 20 degrees. People
  // turn their soles by some degrees as they stand.
  Quat tilt_of_sole(const LegRoles& leg, const Vec3& front) const {
    const auto& heel = heels_[leg.foot == Role::left_foot ? 0 : 1];
    if (!heel) return Quat::Identity();
    const Quat& ankle = source_.orientation(source_.joint(leg.foot));
    const Vec3 left = front.cross(ankle * *heel).stableNormalized();
    const Vec3 ahead = left.cross(kUp).stableNormalized();  // of the foot once it is flat
    const Vec3 heading = (front - front.dot(kUp) * kUp).stableNormalized();
    const double wider = spread_of(source_, leg) - spread_of(target_, leg);
    const double tilt =
        std::clamp(std::asin(std::clamp(left.y(), -1.0, 1.0)), std::min(0.0, kMaxTilt * wider),
                   std::max(0.0, kMaxTilt * wider));
    const double size = std::abs(tilt);
    const double share = smooth_step(degrees(5), degrees(10), size) *
                         (1 - smooth_step(degrees(40), degrees(50), size));
    const double yaw = std::atan2(heading.cross(ahead).dot(kUp), heading.dot(ahead));
    return from_rotation_vector(share * tilt * ahead) * from_rotation_vector(share * yaw * kUp);
  }

  // The angle of a leg to its body's left from straight down, in the reference pose.
  static double spread_of(const ActorView& actor, const LegRoles& leg) {
    const auto left = actor.left(Role::left_upper_leg, Role::right_upper_leg);
    const auto down = actor.direction(actor.joint(leg.upper), actor.joint(leg.foot));
    return left && down ? std::atan2(down->dot(*left), -down->dot(kUp)) : 0;
  }

  // Joints that were not set follow their parents.
  void hand_down() {
    for (std::size_t k = 0; k < turns_.size(); ++k) {
      if (set_[k] != 0) continue;
      const int parent = target_.skeleton().parents[k];
      turns_[k] = parent >= 0 ? turns_[at(parent)] : hips_;
    }
  }

  ActorView source_;
  ActorView target_;
  const JointMapping& mapping_;
  std::array<std::optional<Vec3>, 2> heels_;
  std::vector<Quat> turns_;
  std::vector<char> set_;
  Quat hips_ = Quat::Identity();
  Quat standing_ = Quat::Identity();  // of the body that feet stand under
  Quat chest_ = Quat::Identity();
};

// The rotation that best maps one set of directions to another (Kabsch algorithm, by the signed
// polar decomposition of their correlation).
Quat best_turn(const std::vector<Vec3>& from, const std::vector<Vec3>& to, const Quat& fallback) {
  if (from.empty()) return fallback;
  if (from.size() == 1) return shortest_arc(fallback * from[0], to[0]) * fallback;
  Mat3 correlation = Mat3::Zero();
  for (std::size_t i = 0; i < from.size(); ++i) correlation += to[i] * from[i].transpose();
  const Eigen::JacobiSVD<Mat3> svd(correlation, Eigen::ComputeFullU | Eigen::ComputeFullV);
  // Collinear directions leave the rotation about their line undefined.
  if (!(svd.singularValues()[1] > 1e-3 * svd.singularValues()[0])) {
    return shortest_arc(fallback * from[0], to[0]) * fallback;
  }
  Mat3 sign = Mat3::Identity();
  if ((svd.matrixU() * svd.matrixV().transpose()).determinant() < 0) sign(2, 2) = -1;
  return normalized_or_identity(Quat(Mat3(svd.matrixU() * sign * svd.matrixV().transpose())));
}

}  // namespace

std::vector<Quat> align_by_roles(const Actor& source, const Actor& target,
                                 const JointMapping& mapping,
                                 const std::array<std::optional<Vec3>, 2>& heels) {
  return Aligner(source, target, mapping, heels).align();
}

std::vector<Quat> align_by_names(const Actor& source, const Actor& target,
                                 const JointMapping& mapping) {
  const ActorView from(target);
  const ActorView to(source);
  const auto children = target.skeleton.children();
  std::vector<Quat> turns(mapping.size(), Quat::Identity());
  for (int k = 0; k < target.skeleton.joint_count(); ++k) {
    const int parent = target.skeleton.parents[at(k)];
    const Quat above = parent >= 0 ? turns[at(parent)] : Quat(Quat::Identity());
    turns[at(k)] = above;
    if (mapping[at(k)].first < 0) continue;
    std::vector<Vec3> now, wanted;
    for (const int child : children[at(k)]) {
      if (mapping[at(child)].first < 0) continue;
      const auto a = from.direction(k, child);
      const auto b = to.direction(mapping[at(k)].first, mapping[at(child)].first);
      if (!a || !b) continue;
      now.push_back(*a);
      wanted.push_back(*b);
    }
    turns[at(k)] = best_turn(now, wanted, above);
  }
  return turns;
}

int foot_front(const Skeleton& skeleton, const RoleMap& roles, Role foot) {
  const int ankle = roles.joint(foot);
  if (ankle < 0) return -1;
  const std::vector<int> toes = first_toes(skeleton, roles, foot);
  if (!toes.empty()) return toes[toes.size() / 2];
  int front = -1;
  double furthest = 0;
  for (int j = ankle + 1; j < skeleton.joint_count(); ++j) {
    if (skeleton.parents[at(j)] != ankle || skeleton.end_sites[at(j)] == 0) continue;
    const double distance =
        (skeleton.reference[at(j)].position - skeleton.reference[at(ankle)].position).norm();
    if (distance <= furthest) continue;
    front = j;
    furthest = distance;
  }
  return front;
}

}  // namespace krok::retarget
