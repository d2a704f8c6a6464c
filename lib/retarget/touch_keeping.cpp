#include "retarget/touch_keeping.h"

#include <algorithm>
#include <cmath>

#include "contacts/sole_points.h"
#include "core/index.h"
#include "math/quaternion.h"
#include "retarget/actor_view_internal.h"

namespace krok::retarget {

namespace {

constexpr double kUsualLeg = 0.86;  // metres, of a person of 1.75 m
constexpr double kLargestTurn = 20 * kRadiansPerDegree;

// In leg lengths, metres per second of a usual leg, and seconds. Heights are of joints, of hands
// the middle of the palm.
struct GroundLimits {
  BodyPart part;
  double near, far, speed, shortest;
};
constexpr std::array<GroundLimits, kBodyParts> kGroundLimits = {
    {{BodyPart::left_hand, 0.1, 0.35, 0.6, 0.06},
     {BodyPart::right_hand, 0.1, 0.35, 0.6, 0.06},
     {BodyPart::left_elbow, 0.1, 0.3, 0.6, 0.06},
     {BodyPart::right_elbow, 0.1, 0.3, 0.6, 0.06},
     {BodyPart::left_knee, 0.11, 0.3, 0.6, 0.06},
     {BodyPart::right_knee, 0.11, 0.3, 0.6, 0.06},
     {BodyPart::left_foot, 0.09, 0.25, 0.6, 0.06},
     {BodyPart::right_foot, 0.09, 0.25, 0.6, 0.06},
     {BodyPart::hips, 0.22, 0.5, 0.3, 0.2}}};
constexpr double kHandsNear = 0.15, kHandsFar = 0.4;  // leg lengths between palms
constexpr double kSlowOnBody = 0.25;                  // metres per second
constexpr double kLongOnBody = 0.2;                   // seconds
constexpr double kBeyondEnd = 4;  // times what a palm is beyond a bone's end counts as distance

BodyPart other_side(BodyPart left, std::size_t side) {
  return static_cast<BodyPart>(static_cast<std::size_t>(left) + side);
}

// Metres per second over two frames.
std::vector<double> speeds_of(std::span<const Vec3> places, double rate) {
  const int count = static_cast<int>(places.size());
  std::vector<double> speeds(places.size(), 0);
  for (int f = 0; f < count && count > 1; ++f) {
    const int before = std::max(f - 1, 0), after = std::min(f + 1, count - 1);
    speeds[at(f)] = (places[at(after)] - places[at(before)]).norm() * rate / (after - before);
  }
  return speeds;
}

Vec3 place_of(const BodyPoint& point, const Clip& clip, int frame) {
  const Vec3 joint = clip.frame_positions(frame)[at(point.joint)].cast<double>();
  if (point.offset.isZero(0)) return joint;
  return clip.frame_orientations(frame)[at(point.joint)].cast<double>() * point.offset + joint;
}

// In the frames of `stay`.
std::vector<Vec3> track_of(const Clip& clip, const BodyPoint& point, const Stay& stay) {
  std::vector<Vec3> places;
  places.reserve(at(stay.last - stay.first + 1));
  for (int f = stay.first; f <= stay.last; ++f) places.push_back(place_of(point, clip, f));
  return places;
}

std::vector<Vec3> track_of(const Clip& clip, const BodyPoint& point) {
  return track_of(clip, point, {0, clip.frame_count() - 1});
}

BesideLine beside_bone(const Vec3& point, int from, int to, std::span<const Transform> pose) {
  return beside_line(point, pose[at(from)].position, pose[at(to)].position);
}

Vec3 on_line(double along, int from, int to, std::span<const Transform> pose) {
  return pose[at(from)].position + along * (pose[at(to)].position - pose[at(from)].position);
}

}  // namespace

ShiftSolver::ShiftSolver(double leg) : leg_(leg) {
  // Hips keep their height and more so their place, the trunk its turn, where little is lacking.
  const double turn = 0.02 * leg * leg;
  squares_.diagonal() << 0.3, 0.02, 0.3, turn, turn, turn;
}

void ShiftSolver::add(double weight, const Vec3& along, double across, const Vec3& lack,
                      const std::optional<Vec3>& arm) {
  if (!(weight > 0)) return;
  const auto add_row = [&](const Vec3& axis, double strength) {
    Eigen::Matrix<double, 6, 1> row;
    row << axis, (arm ? Vec3(arm->cross(axis)) : Vec3(Vec3::Zero()));
    squares_ += strength * row * row.transpose();
    right_ += strength * axis.dot(lack) * row;
  };
  add_row(along, weight);
  for (int axis = 0; axis < 3; ++axis) add_row(Vec3::Unit(axis), weight * across);
}

BodyShift ShiftSolver::solve() const {
  const Eigen::Matrix<double, 6, 1> x = squares_.ldlt().solve(right_);
  BodyShift shift{x.head<3>(), x.tail<3>()};
  const auto limit = [](Vec3& v, double most) {
    if (v.norm() > most) v *= most / v.norm();
  };
  limit(shift.hips, 0.35 * leg_);
  limit(shift.turn, kLargestTurn);
  return shift;
}

std::vector<BodyShift> smoothed(const std::vector<BodyShift>& shifts, int reach) {
  const int count = static_cast<int>(shifts.size());
  std::vector<BodyShift> result(shifts.size());
  std::vector<double> weights;  // [2 reach + 1]
  for (int k = -reach; k <= reach; ++k) weights.push_back(1 + std::cos(kPi * k / (reach + 1)));
  for (int i = 0; i < count; ++i) {
    double all = 0;
    for (int k = -reach; k <= reach; ++k) {
      const double weight = weights[at(k + reach)];
      const BodyShift& other = shifts[at(std::clamp(i + k, 0, count - 1))];
      result[at(i)].hips += weight * other.hips;
      result[at(i)].turn += weight * other.turn;
      all += weight;
    }
    result[at(i)].hips /= all;
    result[at(i)].turn /= all;
  }
  return result;
}

TouchKeeping::TouchKeeping(const Clip& clip, const Actor& source, const Actor& target, double scale,
                           double floor, double leg, bool on_ground)
    : points_(body_points(source, target)),
      scale_(scale),
      leg_(leg),
      parents_(target.skeleton.parents) {
  const auto limb = [&](Role upper, Role lower, Role end, const Vec3& hinge) {
    const int a = target.roles.joint(upper), b = target.roles.joint(lower),
              c = target.roles.joint(end);
    return a < 0 || b < 0 || c < 0 ? std::nullopt
                                   : std::optional(MovedLimb(target, a, b, c, hinge, a));
  };
  const auto place = [&](Role role) { return target.pose[at(target.roles.joint(role))].position; };
  const Vec3 left = place(Role::left_upper_leg) - place(Role::right_upper_leg);
  for (std::size_t side = 0; side < 2; ++side) {
    const ArmRoles& arm = kArmRoles[side];
    const LegRoles& leg_roles = kLegRoles[side];
    legs_[side] = limb(leg_roles.upper, leg_roles.lower, leg_roles.foot, left);
    // Forearms swing forwards.
    if (target.roles.joint(arm.lower) < 0) continue;
    const Vec3 bone = place(arm.lower) - place(arm.upper);
    arms_[side] = limb(arm.upper, arm.lower, arm.hand, bone.cross(left.cross(kUp)));
  }
  const int hips = target.roles.joint(Role::hips);
  turns_with_trunk_.assign(target.skeleton.names.size(), 0);
  for (int j = target.roles.joint(Role::left_upper_arm); j >= 0 && j != hips; j = parents_[at(j)]) {
    pivot_ = j;
  }
  for (const int joint : joints_below(target.skeleton, std::max(pivot_, 0)))
    turns_with_trunk_[at(joint)] = 1;
  for (const Role role : {Role::head, Role::left_hand, Role::right_hand}) {
    const int top = target.roles.joint(role);
    if (top < 0 || turns_with_trunk_[at(top)] == 0) continue;
    for (const int joint : joints_below(target.skeleton, top)) turns_with_trunk_[at(joint)] = 2;
  }
  if (on_ground) find_on_ground(clip, floor, leg);
}

void TouchKeeping::find_on_ground(const Clip& clip, double floor, double leg) {
  for (const GroundLimits& limits : kGroundLimits) {
    const PointPair& point = points_[static_cast<std::size_t>(limits.part)];
    if (point.source.joint < 0) continue;
    OnGround entry{limits.part, point, {}, track_of(clip, point.source), {}, {}};
    std::vector<double> heights;
    for (const Vec3& place : entry.place) heights.push_back(place.y() - floor);
    entry.touch = find_touch(
        heights, speeds_of(entry.place, clip.rate),
        {limits.near * leg, limits.far * leg, limits.speed * leg / kUsualLeg, limits.shortest},
        clip.rate);
    if (entry.touch.stays.empty()) continue;
    for (Vec3& place : entry.place) place *= scale_;
    entry.natural.resize(entry.place.size());
    ground_.push_back(std::move(entry));
  }
}

void TouchKeeping::find_on_body(const Clip& clip, const Actor& source, const Actor& target,
                                double leg) {
  std::array<std::vector<Vec3>, 2> palms;
  for (std::size_t side = 0; side < 2; ++side) {
    const BodyPoint& palm = points_[side].source;
    if (palm.joint < 0 || !arms_[side] || clip.frame_count() == 0) return;
    palms[side] = track_of(clip, palm);
  }
  const auto frames = at(clip.frame_count());
  std::vector<double> distance(frames), speed(frames, 0.0);
  for (std::size_t f = 0; f < frames; ++f) distance[f] = (palms[1][f] - palms[0][f]).norm();
  Touch hands = find_touch(distance, speed, {kHandsNear * leg, kHandsFar * leg, 1, 0}, clip.rate);
  if (!hands.stays.empty()) hands_ = std::move(hands);

  for (const BodyBone& bone : body_bones(source, target)) {
    const auto from = track_of(clip, {bone.from, Vec3::Zero()});
    const auto to = track_of(clip, {bone.to, Vec3::Zero()});
    for (std::size_t side = 0; side < 2; ++side) {
      if (bone.is_left && *bone.is_left == (side == 0)) continue;  // the hand's own arm
      std::vector<Vec3> off(frames);
      for (std::size_t f = 0; f < frames; ++f) {
        const BesideLine beside = beside_line(palms[side][f], from[f], to[f]);
        off[f] = palms[side][f] - (from[f] + beside.along * (to[f] - from[f]));
        const double height = (palms[side][f] - from[f]).dot((to[f] - from[f]).stableNormalized());
        const double above = bone.begins * (to[f] - from[f]).norm() - height;
        distance[f] = off[f].norm() + kBeyondEnd * std::max(0.0, above);
        // The palm's place along the bone counts as well as the way to it.
        off[f] += beside.along * (to[f] - from[f]).norm() * Vec3::UnitY();
      }
      Touch touch = find_touch(
          distance, speeds_of(off, clip.rate),
          {bone.radius * leg, 2 * bone.radius * leg, kSlowOnBody * leg / kUsualLeg, kLongOnBody},
          clip.rate);
      if (!touch.stays.empty()) on_body_.push_back({side, bone, std::move(touch)});
    }
  }
}

bool TouchKeeping::needs(int frame, bool again) const {
  return std::ranges::any_of(ground_, [&](const OnGround& entry) {
    return entry.touch.weight[at(frame)] > 0 && (!again || entry.part == BodyPart::hips);
  });
}

void TouchKeeping::note(int frame, std::span<const Transform> target_pose) {
  for (OnGround& entry : ground_) entry.natural[at(frame)] = entry.point.target.in(target_pose);
}

void TouchKeeping::add_stays(const FrameRun& run, GroundStays& stays) const {
  for (const OnGround& entry : ground_) {
    std::vector<GroundStay>& all = stays[static_cast<std::size_t>(entry.part)];
    for (const Stay& stay : entry.touch.stays) {
      const int begin = std::max(stay.first, run.kept_begin);
      const int end = std::min(stay.last + 1, run.kept_end);
      if (begin >= end) continue;
      const bool goes_on = !all.empty() && all.back().stay.last + 1 == run.first + begin;
      if (!goes_on) all.push_back({{run.first + begin, 0}});
      all.back().stay.last = run.first + end - 1;
      for (int f = begin; f < end; ++f) {
        all.back().off += flat(entry.natural[at(f)] - entry.place[at(f)]);
      }
    }
  }
}

void TouchKeeping::settle(const GroundStays& stays, const StancesOfFeet& feet, int first) {
  for (OnGround& entry : ground_) {
    const std::size_t frames = entry.place.size();
    const bool is_left = entry.part == BodyPart::left_foot;
    const bool is_foot = is_left || entry.part == BodyPart::right_foot;
    const auto stances = is_foot ? feet[is_left ? 0 : 1] : std::span<const KeptStance>();
    for (std::size_t f = 0; f < frames && !stances.empty(); ++f) {
      entry.touch.weight[f] *= 1 - stances[at(first) + f].standing;
    }
    entry.shift.assign(frames, Vec3::Zero());
    entry.touch.stays.clear();
    std::vector<Vec3> of_stay;
    for (const auto& [stay, off] : stays[static_cast<std::size_t>(entry.part)]) {
      if (is_foot && !stances.empty() && stances[at((stay.first + stay.last) / 2)].standing > 0.5)
        continue;
      of_stay.push_back(off / (stay.last - stay.first + 1));
      entry.touch.stays.push_back({stay.first - first, stay.last - first});
    }
    if (of_stay.empty()) continue;
    std::size_t next = 0;  // the first stay that does not end before the frame
    for (std::size_t f = 0; f < frames; ++f) {
      const int frame = static_cast<int>(f);
      while (next < of_stay.size() && entry.touch.stays[next].last < frame) ++next;
      if (next == of_stay.size()) {
        entry.shift[f] = of_stay.back();
      } else if (next == 0 || entry.touch.stays[next].first <= frame) {
        entry.shift[f] = of_stay[next];
      } else {
        const double part =
            smooth_step(entry.touch.stays[next - 1].last, entry.touch.stays[next].first, frame);
        entry.shift[f] = of_stay[next - 1] + part * (of_stay[next] - of_stay[next - 1]);
      }
      // The hips are where they are to be.
      if (entry.part == BodyPart::hips) entry.shift[f] = entry.natural[f] - entry.place[f];
    }
  }
  std::erase_if(ground_, [](const OnGround& entry) { return entry.touch.stays.empty(); });
}

const TouchKeeping::OnGround* TouchKeeping::on_ground(BodyPart part) const {
  const auto found = std::ranges::find(ground_, part, &OnGround::part);
  return found == ground_.end() ? nullptr : &*found;
}

double TouchKeeping::weight(BodyPart part, int frame) const {
  const OnGround* entry = on_ground(part);
  return entry == nullptr ? 0 : entry->touch.weight[at(frame)];
}

Vec3 TouchKeeping::lack(BodyPart part, int frame, std::span<const Transform> pose) const {
  const OnGround* entry = on_ground(part);
  if (entry == nullptr || !(entry->touch.weight[at(frame)] > 0)) return Vec3::Zero();
  return entry->touch.weight[at(frame)] *
         (entry->place[at(frame)] + entry->shift[at(frame)] - entry->point.target.in(pose));
}

void TouchKeeping::add_lacks(int frame, std::span<const Transform> pose,
                             ShiftSolver& solver) const {
  for (const OnGround& entry : ground_) {
    const double weight = entry.touch.weight[at(frame)];
    if (!(weight > 0)) continue;
    const Vec3 point = entry.point.target.in(pose);
    const Vec3 lack = entry.place[at(frame)] + entry.shift[at(frame)] - point;
    const auto side = static_cast<std::size_t>(entry.part) % 2;
    const auto along = [&](int root) {
      return Vec3((point - pose[at(root)].position).stableNormalized());
    };
    switch (entry.part) {
      case BodyPart::left_hand:
      case BodyPart::right_hand:
      case BodyPart::left_elbow:
      case BodyPart::right_elbow: {
        if (!arms_[side] || pivot_ < 0) break;
        const int root = arms_[side]->upper();
        // A forearm that lies brings its hand down by itself.
        const bool is_hand = entry.part <= BodyPart::right_hand;
        const double lies =
            is_hand ? this->weight(other_side(BodyPart::left_elbow, side), frame) : 0;
        solver.add((1 - std::min(lies, 1.0)) * weight, along(root), 0.1, lack,
                   pose[at(root)].position - pose[at(pivot_)].position);
        break;
      }
      case BodyPart::left_knee:
      case BodyPart::right_knee:
        if (legs_[side]) solver.add(weight, along(legs_[side]->upper()), 0.1, lack, {});
        break;
      case BodyPart::hips:
        solver.add(3 * weight, Vec3::UnitY(), 1, lack, {});
        break;
      default:
        break;
    }
  }
}

void TouchKeeping::turn_trunk(const Vec3& turn, std::span<const Transform> local,
                              std::span<Transform> pose) const {
  if (pivot_ < 0 || turn.isZero()) return;
  const Quat by = from_rotation_vector(turn);
  // Parents come first: each joint hangs on its parent as it has become.
  for (std::size_t j = at(pivot_); j < pose.size(); ++j) {
    if (turns_with_trunk_[j] == 0) continue;
    // Positions are kept in the parents' frames.
    if (static_cast<int>(j) != pivot_) {
      pose[j].position = pose[at(parents_[j])] * local[j].position;
    }
    if (turns_with_trunk_[j] == 1) pose[j].orientation = (by * pose[j].orientation).normalized();
  }
}

void TouchKeeping::place_knees(int frame, std::span<const Transform> local,
                               std::span<Transform> pose) const {
  for (std::size_t side = 0; side < 2; ++side) {
    const BodyPart knee = other_side(BodyPart::left_knee, side);
    const Vec3 way = lack(knee, frame, pose);
    if (!legs_[side] || way.isZero()) continue;
    legs_[side]->aim_middle(pose[at(legs_[side]->lower())].position + way, local, pose);
  }
}

void TouchKeeping::place_feet(int frame, std::span<const Transform> local,
                              std::span<Transform> pose) const {
  for (std::size_t side = 0; side < 2; ++side) {
    const BodyPart foot = other_side(BodyPart::left_foot, side);
    const Vec3 way = lack(foot, frame, pose);
    if (!legs_[side] || way.isZero()) continue;
    const double kneels = weight(other_side(BodyPart::left_knee, side), frame);
    legs_[side]->move_end((1 - kneels) * way, local, pose);
    const Vec3 rest = lack(foot, frame, pose);
    const Vec3 point = on_ground(foot)->point.target.in(pose);
    legs_[side]->aim_end(point, point + kneels * rest, local, pose);
  }
}

void TouchKeeping::place_arms(int frame, std::span<const Transform> source_pose,
                              std::span<const Transform> local, std::span<Transform> pose) const {
  std::array<Vec3, 2> goals, from;
  for (std::size_t side = 0; side < 2; ++side) {
    if (!arms_[side]) return;
    const BodyPart elbow = other_side(BodyPart::left_elbow, side);
    const Vec3 way = lack(elbow, frame, pose);
    if (!way.isZero()) {
      arms_[side]->aim_middle(pose[at(arms_[side]->lower())].position + way, local, pose);
    }
    goals[side] = from[side] = points_[side].target.in(pose);
  }
  // On the body: of several bones the mean, the whole way once one of them is touched.
  std::array<double, 2> all = {0, 0}, largest = {0, 0};
  std::array<Vec3, 2> ways = {Vec3::Zero(), Vec3::Zero()};
  for (const OnBody& entry : on_body_) {
    const double weight = entry.touch.weight[at(frame)];
    if (!(weight > 0)) continue;
    const BodyBone& bone = entry.bone;
    const BesideLine beside =
        beside_bone(points_[entry.side].source.in(source_pose), bone.from, bone.to, source_pose);
    ways[entry.side] += weight * (on_line(beside.along, bone.onto_from, bone.onto_to, pose) +
                                  scale_ * beside.off - from[entry.side]);
    all[entry.side] += weight;
    largest[entry.side] = std::max(largest[entry.side], std::min(weight, 1.0));
  }
  for (std::size_t side = 0; side < 2; ++side) {
    if (all[side] > 0) goals[side] += largest[side] / all[side] * ways[side];
  }
  std::array<double, 2> on_floor;
  for (std::size_t side = 0; side < 2; ++side) {
    const BodyPart hand = other_side(BodyPart::left_hand, side);
    on_floor[side] = std::min(weight(hand, frame), 1.0);
    goals[side] =
        from[side] + (1 - on_floor[side]) * (goals[side] - from[side]) + lack(hand, frame, pose);
  }
  // Each other: both hands go half the way, on the ground along it.
  if (hands_ && hands_->weight[at(frame)] > 0) {
    const Vec3 apart =
        scale_ * (points_[1].source.in(source_pose)-points_[0].source.in(source_pose));
    Vec3 half = 0.5 * hands_->weight[at(frame)] * (apart - (goals[1] - goals[0]));
    half.y() *= 1 - std::max(on_floor[0], on_floor[1]);
    goals[0] -= half;
    goals[1] += half;
  }
  for (std::size_t side = 0; side < 2; ++side) {
    const Vec3 way = goals[side] - from[side];
    if (way.isZero()) continue;
    const double leans = std::min(1.0, weight(other_side(BodyPart::left_elbow, side), frame));
    arms_[side]->move_end((1 - leans) * way, local, pose);
    if (leans == 0) continue;
    const Vec3 point = points_[side].target.in(pose);
    arms_[side]->aim_end(point, point + leans * (goals[side] - point), local, pose);
  }
}

std::vector<KeptContact> kept_contacts(std::span<const Contact> contacts, const Actor& source,
                                       const Actor& target, double scale,
                                       const std::array<Floor, 2>& source_floors,
                                       const Floor& target_floor, double rate,
                                       const StancesOfFeet& feet,
                                       const std::array<std::optional<PointPair>, 2>& heels) {
  std::vector<KeptContact> kept;
  for (const Contact& contact : contacts) {
    const Role role = source.roles.roles[at(contact.joint)];
    for (const bool is_left : {true, false}) {
      const LegRoles& leg = kLegRoles[is_left ? 0 : 1];
      if (role != leg.foot && role != leg.toes) continue;
      const int onto = target.roles.joint(role);
      if (onto < 0 || target.roles.joint(leg.foot) < 0) continue;
      const Floor& source_floor = source_floors[is_left ? 0 : 1];
      const auto height = [&](const Actor& actor, int joint, const Floor& floor) {
        return actor.pose[at(joint)].position.y() - lowest_of_foot(actor, leg.foot) + floor.sole +
               floor.motion;
      };
      KeptContact entry;
      entry.part = std::string(is_left ? "left " : "right ") + (role == leg.foot ? "heel" : "ball");
      entry.point = {at_joint(contact.joint), at_joint(onto)};
      entry.stay = {static_cast<int>(std::ceil(contact.start * rate - 1e-6)),
                    static_cast<int>(std::floor(contact.end * rate + 1e-6))};
      if (const auto& heel = heels[is_left ? 0 : 1]; heel && role == leg.foot) {
        entry.point = *heel;
        entry.rise = target_floor.motion - scale * source_floor.motion;
      } else {
        entry.rise = height(target, onto, target_floor) -
                     scale * height(source, contact.joint, source_floor);
      }
      // A foot that lies on the ground, as in kneeling, is found on its own.
      const auto& stances = feet[is_left ? 0 : 1];
      const int middle = (entry.stay.first + entry.stay.last) / 2;
      if (!stances.empty() && stances[at(middle)].standing < 0.5) continue;
      if (entry.stay.last > entry.stay.first) kept.push_back(std::move(entry));
    }
  }
  return kept;
}

double TouchKeeping::height_off(const Vec3& from, const Vec3& onto, double rise,
                                const GroundHeight& ground) const {
  const auto off = [&](double below_from, double below_onto) {
    return std::abs(onto.y() - below_onto - scale_ * (from.y() - below_from) - rise);
  };
  if (!ground) return off(0, 0);
  const auto below_from = ground(from), below_onto = ground(onto);
  if (!below_from && !below_onto) return 0;
  // Of an end of a foot that is over an edge, or a hole, the other actor's is not.
  const double higher =
      std::max(below_from.value_or(*below_onto), below_onto.value_or(*below_from));
  const double over_higher = off(higher, higher);
  return below_from && below_onto ? std::min(over_higher, off(*below_from, *below_onto))
                                  : over_higher;
}

std::vector<ContactReport> TouchKeeping::report(const FrameRun& run,
                                                std::span<const KeptContact> kept,
                                                const Clip& result,
                                                const GroundHeight& ground) const {
  const Clip& source = run.clip;
  std::vector<ContactReport> reports;
  const auto add = [&](const char* part, const char* on, std::span<const Stay> stays,
                       const auto& measure) {
    for (Stay stay : stays) {
      // With one frame before the kept ones, as speeds are of two.
      stay.first = std::max(stay.first, std::max(run.kept_begin - 1, 0));
      stay.last = std::min(stay.last, run.kept_end - 1);
      if (stay.last < stay.first) continue;
      ContactReport report;
      report.part = part;
      report.on = on;
      report.start = (run.first + stay.first) / source.rate;
      report.end = (run.first + stay.last) / source.rate;
      measure(stay, report);
      reports.push_back(std::move(report));
    }
  };
  const auto add_ground = [&](const char* part, std::span<const Stay> stays, const PointPair& point,
                              double rise) {
    add(part, "ground", stays, [&](const Stay& stay, ContactReport& report) {
      const std::vector<Vec3> places = track_of(result, point.target, stay);
      const std::vector<Vec3> from = track_of(source, point.source, stay);
      double way = 0, source_way = 0;
      for (std::size_t f = 0; f < places.size(); ++f) {
        report.height = std::max(report.height, height_off(from[f], places[f], rise, ground));
        if (f == 0) continue;
        way += flat(places[f] - places[f - 1]).norm();
        source_way += flat(from[f] - from[f - 1]).norm();
      }
      report.joint = point.target.joint;
      const double seconds = report.end - report.start;
      if (seconds > 0) report.slide = way / seconds, report.source_slide = source_way / seconds;
    });
  };
  for (const OnGround& entry : ground_) {
    add_ground(name_of(entry.part), entry.touch.stays, entry.point, 0);
  }
  for (const KeptContact& entry : kept) {
    Stay stay{entry.stay.first - run.first, entry.stay.last - run.first};
    const Stay first{0, std::min(3, source.frame_count() - 1)};
    const bool jumps = run.first == 0 && stay.first == 0 &&
                       jumps_at_start(track_of(source, entry.point.source, first), leg_);
    if (jumps && ++stay.first >= stay.last) continue;
    add_ground(entry.part.c_str(), {&stay, 1}, entry.point, entry.rise);
  }
  // The largest difference of distances, which are distance(clip, frame, whether it is the source).
  const auto add_apart = [&](const char* part, const char* on, std::span<const Stay> stays,
                             const auto& distance) {
    add(part, on, stays, [&](const Stay& stay, ContactReport& report) {
      for (int f = stay.first; f <= stay.last; ++f) {
        const double off = distance(result, f, false) - scale_ * distance(source, f, true);
        report.apart = std::max(report.apart, std::abs(off));
      }
    });
  };
  const auto palm = [&](std::size_t side, const Clip& clip, int frame, bool of_source) {
    const PointPair& point = points_[side];
    return place_of(of_source ? point.source : point.target, clip, frame);
  };
  if (hands_) {
    add_apart(name_of(BodyPart::left_hand), "right hand", hands_->stays,
              [&](const auto&... frame) { return (palm(1, frame...) - palm(0, frame...)).norm(); });
  }
  for (const OnBody& entry : on_body_) {
    const BodyBone& bone = entry.bone;
    add_apart(name_of(other_side(BodyPart::left_hand, entry.side)), bone.name, entry.touch.stays,
              [&](const Clip& clip, int frame, bool of_source) {
                const auto end = [&](int from, int onto) {
                  return place_of(at_joint(of_source ? from : onto), clip, frame);
                };
                return beside_line(palm(entry.side, clip, frame, of_source),
                                   end(bone.from, bone.onto_from), end(bone.to, bone.onto_to))
                    .off.norm();
              });
  }
  std::ranges::stable_sort(reports, {}, &ContactReport::start);
  return reports;
}

}  // namespace krok::retarget
