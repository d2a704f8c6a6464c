#include "retarget/foot_placement.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "contacts/legs.h"
#include "core/index.h"
#include "ik/soft_reach.h"
#include "math/window.h"
#include "retarget/actor_view_internal.h"
#include "retarget/touch_keeping.h"

namespace krok::retarget {

namespace {

// Heights of a foot, in leg lengths, between which its place gives way to the leg's rotations.
constexpr double kNearFloor = 0.08;
constexpr double kFarFromFloor = 0.25;

// The directions `across`, each the mean over its stance: in contact, or out of it for less than
// `reach` frames. From one stance to the next as given, without a jump.
std::vector<Eigen::Vector2f> held_in_stances(std::vector<Eigen::Vector2f> across,
                                             std::vector<char> stands, int reach) {
  const int frames = static_cast<int>(across.size());
  const auto for_runs = [&](char of, const auto& body) {
    for (int f = 0; f < frames; ++f) {
      int end = f;
      while (end < frames && stands[at(end)] == of) ++end;
      if (end > f) body(f, end);
      f = std::max(f, end - 1);
    }
  };
  for_runs(0, [&](int begin, int end) {
    if (begin == 0 || end == frames || end - begin >= reach) return;
    std::fill(stands.begin() + begin, stands.begin() + end, char{1});
  });
  const std::vector<Eigen::Vector2f> given = across;
  for_runs(1, [&](int begin, int end) {
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    for (int f = begin; f < end; ++f) sum += given[at(f)].cast<double>();
    const Eigen::Vector2f mean = (sum / (end - begin)).cast<float>();
    std::fill(across.begin() + begin, across.begin() + end, mean);
  });
  for_runs(0, [&](int begin, int end) {
    const int soft = std::min(reach, (end - begin) / 2);
    for (int f = begin; f < end; ++f) {
      if (begin > 0) {
        across[at(f)] += static_cast<float>(1 - smooth_step(begin - 1, begin + soft, f)) *
                         (across[at(begin - 1)] - given[at(begin)]);
      }
      if (end < frames) {
        across[at(f)] += static_cast<float>(smooth_step(end - 1 - soft, end, f)) *
                         (across[at(end)] - given[at(end - 1)]);
      }
    }
  });
  return across;
}

double elevation(const Vec3& v) {
  const double length = v.norm();
  return length > 0 ? std::asin(std::clamp(v.y() / length, -1.0, 1.0)) : 0.0;
}

}  // namespace

double lowest_of_foot(const Actor& actor, Role foot) {
  double lowest = std::numeric_limits<double>::max();
  for (const int joint : joints_below(actor.skeleton, actor.roles.joint(foot))) {
    lowest = std::min(lowest, actor.pose[at(joint)].position.y());
  }
  return lowest;
}

double ankle_over_floor(const Actor& actor, Role foot, const Floor& floor) {
  const double ankle = actor.pose[at(actor.roles.joint(foot))].position.y();
  return ankle - lowest_of_foot(actor, foot) + floor.sole;
}

void add_lowest(const Clip& clip, const Actor& stance, LowestOfFeet& lowest) {
  for (std::size_t side = 0; side < 2; ++side) {
    const Role foot = side == 0 ? Role::left_foot : Role::right_foot;
    const double sole = lowest_of_foot(stance, foot);
    std::vector<std::pair<int, float>> heights;  // joints, above the lowest
    for (const int joint : joints_below(stance.skeleton, stance.roles.joint(foot))) {
      heights.emplace_back(joint, static_cast<float>(stance.pose[at(joint)].position.y() - sole));
    }
    for (int frame = 0; frame < clip.frame_count(); ++frame) {
      const auto positions = clip.frame_positions(frame);
      float least = std::numeric_limits<float>::max();
      for (const auto& [joint, height] : heights) {
        least = std::min(least, positions[at(joint)].y() - height);
      }
      lowest[side].push_back(least);
    }
  }
}

StandingHeight standing_height(LowestOfFeet lowest) {
  const auto in_stance = [](std::vector<float> heights) -> double {
    if (heights.empty()) return 0;
    const auto place = heights.begin() + static_cast<std::ptrdiff_t>(heights.size() / 5);
    std::nth_element(heights.begin(), place, heights.end());
    return static_cast<double>(*place);
  };
  std::vector<float> lower = lowest[0];
  for (std::size_t f = 0; f < lower.size(); ++f) lower[f] = std::min(lower[f], lowest[1][f]);
  StandingHeight standing;
  standing.lower = in_stance(std::move(lower));
  for (std::size_t side = 0; side < 2; ++side) {
    standing.of_foot[side] = in_stance(std::move(lowest[side]));
  }
  return standing;
}

std::vector<FootPoint> LegPlacement::points_of_foot(const Actor& actor, int ankle, double floor,
                                                    std::span<const BodyPoint> more) {
  std::vector<FootPoint> points;
  const auto height = [&](const BodyPoint& point) { return point.in(actor.pose).y() - floor; };
  const std::vector<int> joints = joints_below(actor.skeleton, ankle);
  for (const int joint : joints) points.push_back({at_joint(joint), height(at_joint(joint))});
  // What is on the surface may come down to the sole.
  double sole = std::numeric_limits<double>::max();
  for (const BodyPoint& point : more) {
    if (!std::ranges::binary_search(joints, point.joint)) continue;
    points.push_back({point});
    sole = std::min(sole, height(point));
  }
  for (std::size_t i = joints.size(); i < points.size(); ++i) points[i].height = sole;
  return points;
}

std::optional<LegPlacement> LegPlacement::create(const Actor& source, const Actor& target,
                                                 std::span<const Quat> turns, double scale,
                                                 const Floor& source_floor,
                                                 const Floor& target_floor, bool is_left,
                                                 const std::optional<Vec3>& heel,
                                                 std::span<const BodyPoint> source_points,
                                                 std::span<const BodyPoint> target_points) {
  const auto& [upper, lower, foot, toes] = kLegRoles[is_left ? 0 : 1];
  const int upper_joint = target.roles.joint(upper), lower_joint = target.roles.joint(lower);
  const int ankle_joint = target.roles.joint(foot);
  if (source.roles.joint(foot) < 0 || upper_joint < 0 || lower_joint < 0 || ankle_joint < 0) {
    return std::nullopt;
  }
  const auto to = [&](Role role) { return target.pose[at(target.roles.joint(role))].position; };
  const Vec3 left = to(Role::left_upper_leg) - to(Role::right_upper_leg);
  LegPlacement leg(MovedLimb(target, upper_joint, lower_joint, ankle_joint, left, ankle_joint));
  leg.scale_ = scale;
  leg.source_floor_ = source_floor;
  leg.target_floor_ = target_floor;
  leg.source_knee_ = source.roles.joint(lower);
  leg.source_ankle_ = source.roles.joint(foot);
  const auto from = [&](int joint) { return source.pose[at(joint)].position; };
  leg.leg_ = (from(leg.source_knee_) - from(source.roles.joint(upper))).norm() +
             (from(leg.source_ankle_) - from(leg.source_knee_)).norm();
  leg.source_front_ = foot_front(source.skeleton, source.roles, foot);
  leg.find_soles(source, target, turns[at(ankle_joint)], foot, heel);
  const Role other = kLegRoles[is_left ? 1 : 0].upper;
  leg.source_hip_ = source.roles.joint(upper);
  leg.source_other_hip_ = source.roles.joint(other);
  const double width = (from(leg.source_hip_) - from(leg.source_other_hip_)).norm();
  leg.beside_ = beside_for_hips(left.norm(), scale * width, leg.limb_.length(target.pose));

  leg.source_points_ = points_of_foot(
      source, leg.source_ankle_, lowest_of_foot(source, foot) - source_floor.sole, source_points);
  const auto is_joint = [](const FootPoint& point) { return point.point.offset.isZero(0); };
  leg.source_joints_ =
      static_cast<std::size_t>(std::ranges::count_if(leg.source_points_, is_joint));
  leg.target_points_ = points_of_foot(
      target, ankle_joint, lowest_of_foot(target, foot) - target_floor.sole, target_points);
  leg.foot_bend_ = FootBend(target, foot, leg.target_points_);
  return leg;
}

void LegPlacement::find_soles(const Actor& source, const Actor& target, const Quat& turn, Role foot,
                              const std::optional<Vec3>& heel) {
  const auto reach = [&](const Actor& actor, int front) {
    const int ankle = actor.roles.joint(foot);
    return front < 0 ? Vec3(Vec3::Zero())
                     : flat(actor.pose[at(front)].position - actor.pose[at(ankle)].position);
  };
  // Distance of the ball ahead of the ankle: at the toes, otherwise from the other skeleton, or a
  // fraction of the way to the tip.
  const bool source_toes = !first_toes(source.skeleton, source.roles, foot).empty();
  const bool target_toes = !first_toes(target.skeleton, target.roles, foot).empty();
  const Vec3 source_reach = reach(source, source_front_);
  double source_ball = source_reach.norm();
  double target_ball = reach(target, foot_front(target.skeleton, target.roles, foot)).norm();
  if (!source_toes) source_ball = target_toes ? target_ball / scale_ : 0.65 * source_ball;
  if (!target_toes) target_ball = scale_ * source_ball;

  Vec3 heading = source_reach.stableNormalized();
  if (heading.isZero()) {
    const auto place = [&](Role role) {
      return source.pose[at(source.roles.joint(role))].position;
    };
    heading = flat(place(Role::left_upper_leg) - place(Role::right_upper_leg)).cross(kUp);
    heading = heading.stableNormalized();
  }
  const Vec3 left = kUp.cross(heading);
  const Quat source_back = source.pose[at(source_ankle_)].orientation.conjugate();
  const Quat target_back = (turn * target.pose[at(limb_.end())].orientation).conjugate();
  onto_target_ = source_back * target_back.conjugate();
  const double source_height = ankle_over_floor(source, foot, source_floor_);
  const double target_height = ankle_over_floor(target, foot, target_floor_);
  const double higher = target_height - scale_ * source_height;
  // From the ankles, in the world, the foot flat.
  const auto sole = [&](const Vec3& from, const Vec3& to) {
    const Vec3 apart = higher * kUp - scale_ * from + to;
    return Sole{source_back * from, target_back * to,
                Vec3(apart.dot(left), apart.y(), apart.dot(heading))};
  };
  const auto toes_of = [&](const Actor& actor, int front, const Quat& turned) {
    const Transform& ankle = actor.pose[at(actor.roles.joint(foot))];
    return Vec3(turned * Vec3(actor.pose[at(front)].position - ankle.position));
  };
  if (source_toes && target_toes) {
    const int front = foot_front(target.skeleton, target.roles, foot);
    ball_ = sole(toes_of(source, source_front_, Quat::Identity()), toes_of(target, front, turn));
  } else {
    ball_ = sole(source_ball * heading - source_height * kUp,
                 target_ball * heading - target_height * kUp);
  }
  // Otherwise behind the ankle, a typical proportion.
  const Vec3 behind = heel ? Vec3(source_back.conjugate() * *heel)
                           : Vec3(-0.3 * source_ball * heading - source_height * kUp);
  heel_ = sole(behind, scale_ * behind - higher * kUp);
  ahead_ = source_back * heading;
  sideways_ = source_back * left;
}

// From the foot's lateral axis, because a foot rolling over its toes briefly points back.
Vec3 LegPlacement::heading_of(const Quat& source_ankle) const {
  return flat((source_ankle * sideways_).cross(kUp)).stableNormalized();
}

LegPlacement::Track LegPlacement::begin_track(std::span<const Contact> contacts, int frames,
                                              double rate) const {
  Track track;
  track.heel.assign(at(frames), 0);
  track.front.assign(at(frames), 0);
  for (const Contact& contact : contacts) {
    const bool own = std::ranges::any_of(
        source_points_, [&](const FootPoint& point) { return point.point.joint == contact.joint; });
    if (!own) continue;
    const int last = std::min(frames - 1, static_cast<int>(std::floor(contact.end * rate)));
    for (auto f = static_cast<int>(std::ceil(contact.start * rate)); f <= last; ++f) {
      (contact.joint == source_ankle_ ? track.heel : track.front)[at(f)] = 1;
    }
  }
  return track;
}

void LegPlacement::add(const Clip& source, int begin, int end, Track& track) const {
  std::vector<Transform> pose(source.skeleton.names.size());
  for (int f = begin; f < end; ++f) {
    source.get_pose(f, pose);
    const char heel = track.heel[track.near.size()], front = track.front[track.near.size()];
    const auto joints = std::span(source_points_).first(source_joints_);
    const double height = lowest_over(source_floor_.motion, joints, pose) / leg_;
    track.near.push_back(
        std::max(1 - smooth_step(kNearFloor, kFarFromFloor, height), heel | front ? 1.0 : 0.0));
    const Vec3 shank = pose[at(source_ankle_)].position - pose[at(source_knee_)].position;
    const double lean = kPi / 2 + elevation(shank);  // angle from straight down
    track.upright.push_back(1 - smooth_step(60 * kRadiansPerDegree, 85 * kRadiansPerDegree, lean));
    const Quat& ankle = pose[at(source_ankle_)].orientation;
    const double rolled = -elevation(ankle * ahead_);
    if (beside_ != 0) {
      const Vec3 across = pose[at(source_hip_)].position - pose[at(source_other_hip_)].position;
      const Vec3 direction = across.stableNormalized();
      track.across.emplace_back(static_cast<float>(direction.x()),
                                static_cast<float>(direction.z()));
    }
    track.rolls.push_back(heel != front ? front : smooth_step(0, 6 * kRadiansPerDegree, rolled));
    if (heel == 0 || front == 0) continue;
    const Vec3 heading = heading_of(ankle);
    const auto over = [&](const Sole& sole) {
      return Vec3(ankle * (scale_ * sole.source - onto_target_ * sole.target));
    };
    const Vec3 apart = over(heel_) - over(ball_);
    track.left.push_back(apart.dot(kUp.cross(heading)));
    track.ahead.push_back(apart.dot(heading));
  }
}

LegPlacement::Stances LegPlacement::find_stances(Track track, double rate) {
  const std::vector<char>&heel = track.heel, &front = track.front;
  std::vector<double>& rolls = track.rolls;
  const int frames = static_cast<int>(rolls.size());
  if (!track.left.empty()) {
    ball_.apart.x() = heel_.apart.x() + median(std::move(track.left));
    ball_.apart.z() = heel_.apart.z() + median(std::move(track.ahead));
  }
  const int reach = softening_reach(rate);
  const auto for_runs = [&](char of, const auto& body) {
    for (int f = 0; f < frames; ++f) {
      int end = f;
      while (end < frames && heel[at(end)] == of && front[at(end)] == of) ++end;
      if (end == f) continue;
      const double before = rolls[at(std::max(f - 1, 0))],
                   after = rolls[at(std::min(end, frames - 1))];
      body(f, end, f > 0 ? before : after, end < frames ? after : before);
      f = end;
    }
  };
  // While both are in contact, either may be placed: from one to the other by then.
  for_runs(1, [&](int begin, int end, double before, double after) {
    for (int f = begin; f < end; ++f) {
      rolls[at(f)] = before + (after - before) * smooth_step(begin - 1, end, f);
    }
  });
  // In the air from and to what is in contact before and after, without a jump.
  for_runs(0, [&](int begin, int end, double before, double after) {
    if (begin > 0) before -= rolls[at(begin)];
    if (end < frames) after -= rolls[at(end - 1)];
    for (int f = begin; f < end; ++f) {
      if (begin > 0) rolls[at(f)] += before * (1 - smooth_step(begin - 1, begin + reach, f));
      if (end < frames) rolls[at(f)] += after * smooth_step(end - 1 - reach, end, f);
      rolls[at(f)] = std::clamp(rolls[at(f)], 0.0, 1.0);
    }
  });
  const std::vector<double> stands = softened(std::exchange(track.near, {}), reach);
  // Shanks swing up from lying in a few frames, as after a handstand.
  const std::vector<double> upright = mean_within(track.upright, reach + 1);
  std::vector<char> still(at(frames));
  for (std::size_t f = 0; f < at(frames); ++f) still[f] = heel[f] | front[f];
  const std::vector<double> touching(still.begin(), still.end());
  Stances result{std::vector<KeptStance>(at(frames)), softened(touching, reach),
                 softened(touching, reach / 4)};
  for (std::size_t f = 0; f < at(frames); ++f) {
    result.feet[f] = {upright[f] * stands[f], rolls[f]};
    result.bearing[f] *= upright[f];
  }
  track.across = held_in_stances(std::move(track.across), std::move(still), reach);
  for (std::size_t f = 0; f < track.across.size(); ++f) {
    const Eigen::Vector2f beside = static_cast<float>(beside_) * track.across[f];
    result.feet[f].beside = {beside.x(), beside.y()};
  }
  return result;
}

void LegPlacement::add_lack(std::span<const Transform> source_pose,
                            std::span<const Transform> target_pose, const FootStance& stance,
                            double bearing, ShiftSolver& solver) const {
  if (!(bearing > 0)) return;
  const Vec3& hip = target_pose[at(limb_.upper())].position;
  const Vec3 leg = target_pose[at(limb_.end())].position - hip;
  const Vec3 goal = goal_of(source_pose, target_pose, stance);
  // A leg of other proportions, bent as the source's, may be folded until its ankle is in the hip,
  // with no direction. No knee bends by over 150 degrees: then it is a quarter of the leg's length
  // away.
  constexpr double kFolded = 0.26, kFree = 0.75;
  const double folded = std::min(
      scale_ *
          (source_pose[at(source_ankle_)].position - source_pose[at(source_hip_)].position).norm(),
      kFolded * limb_.length(target_pose));
  const double is_free = smooth_step(kFree * folded, folded, leg.norm());
  const Vec3 along =
      ((1 - is_free) * (goal - hip).stableNormalized() + is_free * leg.stableNormalized())
          .stableNormalized();
  const Vec3 ankle = hip + std::max(leg.norm(), kFree * folded) * along;
  solver.add(bearing, along, 0, goal - ankle, {});
}

LegPlacement::Way LegPlacement::way(std::span<const Transform> source_pose,
                                    std::span<const Transform> target_pose,
                                    const FootStance& stance) const {
  const Vec3& hip = target_pose[at(limb_.upper())].position;
  const double extension = (target_pose[at(limb_.end())].position - hip).norm();
  return {goal_of(source_pose, target_pose, stance) - hip,
          std::max(extension * (1 + 1e-9), 0.997 * limb_.length(target_pose)), stance.standing};
}

double LegPlacement::Way::lack() const {
  const double beside = flat(to_goal).squaredNorm();
  if (to_goal.norm() <= reach || to_goal.y() >= 0 || beside >= reach * reach) return 0;
  return standing * (-to_goal.y() - std::sqrt(reach * reach - beside));
}

Vec3 LegPlacement::place_of(std::span<const Transform> source_pose,
                            std::span<const Transform> target_pose,
                            const FootStance& stance) const {
  const Vec3 ankle = target_pose[at(limb_.end())].position;
  // A foot that is bent has its ankle where it would have it otherwise.
  const Quat unbent = foot_bend_.turn_of_foot(-stance.bend.foot, target_pose) *
                      target_pose[at(limb_.end())].orientation;
  const auto scaled = [&](const Vec3& point) {
    return Vec3(scale_ * point.x(),
                target_floor_.motion + scale_ * (point.y() - source_floor_.motion),
                scale_ * point.z());
  };

  const Transform& source_ankle = source_pose[at(source_ankle_)];
  const Vec3 heading = heading_of(source_ankle.orientation);
  const auto ankle_over = [&](const Sole& sole) {
    const Vec3 apart = sole.apart.x() * kUp.cross(heading) + sole.apart.y() * kUp;
    return Vec3(scaled(source_ankle * sole.source) + apart + sole.apart.z() * heading -
                unbent * sole.target);
  };
  const Vec3 by_heel = ankle_over(heel_);
  Vec3 goal = by_heel + stance.on_ball * (ankle_over(ball_) - by_heel) +
              Vec3(stance.beside[0], 0, stance.beside[1]);
  return ankle + stance.standing * (goal - ankle);
}

Vec3 LegPlacement::goal_of(std::span<const Transform> source_pose,
                           std::span<const Transform> target_pose, const FootStance& stance) const {
  Vec3 goal = place_of(source_pose, target_pose, stance);
  const double rise = goal.y() - target_pose[at(limb_.end())].position.y();
  const double lies = lowest_over(target_floor_.motion, target_points_, target_pose) + rise;
  goal.y() += std::max(0.0, allowed(source_pose) - lies);
  return goal;
}

double LegPlacement::needed_bend(std::span<const Transform> source_pose,
                                 std::span<const Transform> target_pose,
                                 const FootStance& stance) const {
  const Vec3 way =
      place_of(source_pose, target_pose, stance) - target_pose[at(limb_.end())].position;
  return foot_bend_.needed(target_floor_.motion + allowed(source_pose) - way.y(), target_pose);
}

double LegPlacement::allowed(std::span<const Transform> source_pose) const {
  return std::min(0.0, scale_ * lowest_over(source_floor_.motion, source_points_, source_pose));
}

LegPlacement::Sunk LegPlacement::sunk(std::span<const Transform> source_pose,
                                      std::span<const Transform> target_pose) const {
  Sunk sunk;
  const double lowest = allowed(source_pose);
  for (const FootPoint& point : target_points_) {
    const double depth = lowest - point.over(target_floor_.motion, target_pose);
    if (depth > sunk.depth) sunk = {depth, point.point.joint};
  }
  return sunk;
}

LegPlacement::Outcome LegPlacement::place(std::span<const Transform> source_pose,
                                          std::span<const Transform> local,
                                          const FootStance& stance, double part, double softness,
                                          std::span<Transform> target_pose) const {
  const Vec3 way =
      goal_of(source_pose, target_pose, stance) - target_pose[at(limb_.end())].position;
  return limb_.move_end(part * way, local, target_pose, softness);
}

}  // namespace krok::retarget
