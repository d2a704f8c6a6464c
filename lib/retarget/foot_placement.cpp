#include "retarget/foot_placement.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/index.h"
#include "math/window.h"
#include "retarget/actor_view_internal.h"
#include "retarget/touch_keeping.h"

namespace krok::retarget {

namespace {

// Heights of a foot, in leg lengths, between which its place gives way to the leg's rotations.
constexpr double kNearFloor = 0.08;
constexpr double kFarFromFloor = 0.25;

double elevation(const Vec3& v) {
  const double length = v.norm();
  return length > 0 ? std::asin(std::clamp(v.y() / length, -1.0, 1.0)) : 0.0;
}

}  // namespace

int softening_reach(double rate) {
  constexpr double kMax = 256;  // reached only at thousands of fps
  return static_cast<int>(std::lround(std::min(0.12 * rate, kMax)));
}

std::vector<double> softened(const std::vector<double>& values, int reach) {
  const int count = static_cast<int>(values.size());
  const std::vector<double> widened = max_within(values, reach);
  std::vector<double> result(values.size());
  // Raised-cosine weights.
  std::vector<double> weights;
  double all = 0;
  for (int k = -reach; k <= reach; ++k) {
    weights.push_back(1 + std::cos(kPi * k / (reach + 1)));
    all += weights.back();
  }
  for (int i = 0; i < count; ++i) {
    double sum = 0;
    for (int k = -reach; k <= reach; ++k) {
      sum += weights[at(k + reach)] * widened[at(std::clamp(i + k, 0, count - 1))];
    }
    result[at(i)] = sum / all;
  }
  return result;
}

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

double standing_height(const Clip& clip, const Actor& stance) {
  if (clip.frame_count() == 0) return 0;
  std::vector<std::pair<int, float>> heights;  // foot joints, above the lowest of the foot
  for (const Role foot : {Role::left_foot, Role::right_foot}) {
    const double lowest = lowest_of_foot(stance, foot);
    for (const int joint : joints_below(stance.skeleton, stance.roles.joint(foot))) {
      heights.emplace_back(joint, static_cast<float>(stance.pose[at(joint)].position.y() - lowest));
    }
  }
  std::vector<float> lowest;
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    const auto positions = clip.frame_positions(frame);
    float least = std::numeric_limits<float>::max();
    for (const auto& [joint, height] : heights) {
      least = std::min(least, positions[at(joint)].y() - height);
    }
    lowest.push_back(least);
  }
  const auto place = lowest.begin() + static_cast<std::ptrdiff_t>(lowest.size() / 5);
  std::nth_element(lowest.begin(), place, lowest.end());
  return *place;
}

std::vector<LegPlacement::Point> LegPlacement::points_of_foot(const Actor& actor, int ankle,
                                                              double floor) {
  std::vector<Point> points;
  for (const int joint : joints_below(actor.skeleton, ankle)) {
    points.push_back({joint, actor.pose[at(joint)].position.y() - floor});
  }
  return points;
}

std::optional<LegPlacement> LegPlacement::create(const Actor& source, const Actor& target,
                                                 std::span<const Quat> turns, double scale,
                                                 const Floor& source_floor,
                                                 const Floor& target_floor, bool is_left) {
  const auto& [upper, lower, foot, toes] = kLegRoles[is_left ? 0 : 1];
  const int upper_joint = target.roles.joint(upper), lower_joint = target.roles.joint(lower);
  const int ankle_joint = target.roles.joint(foot);
  if (source.roles.joint(foot) < 0 || upper_joint < 0 || lower_joint < 0 || ankle_joint < 0) {
    return std::nullopt;
  }
  const auto to = [&](Role role) { return target.pose[at(target.roles.joint(role))].position; };
  const Vec3 left = to(Role::left_upper_leg) - to(Role::right_upper_leg);
  LegPlacement leg(MovedLimb(target, upper_joint, lower_joint, ankle_joint, left));
  leg.scale_ = scale;
  leg.source_floor_ = source_floor;
  leg.target_floor_ = target_floor;
  leg.source_knee_ = source.roles.joint(lower);
  leg.source_ankle_ = source.roles.joint(foot);
  const auto from = [&](int joint) { return source.pose[at(joint)].position; };
  leg.leg_ = (from(leg.source_knee_) - from(source.roles.joint(upper))).norm() +
             (from(leg.source_ankle_) - from(leg.source_knee_)).norm();
  leg.source_front_ = foot_front(source.skeleton, source.roles, foot);
  leg.find_soles(source, target, turns[at(ankle_joint)], foot);

  leg.source_points_ =
      points_of_foot(source, leg.source_ankle_, lowest_of_foot(source, foot) - source_floor.sole);
  leg.target_points_ =
      points_of_foot(target, ankle_joint, lowest_of_foot(target, foot) - target_floor.sole);
  return leg;
}

void LegPlacement::find_soles(const Actor& source, const Actor& target, const Quat& turn,
                              Role foot) {
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
  const Quat source_back = source.pose[at(source_ankle_)].orientation.conjugate();
  const Quat target_back = (turn * target.pose[at(limb_.end())].orientation).conjugate();
  const Vec3 source_down = -ankle_over_floor(source, foot, source_floor_) * kUp;
  const Vec3 target_down = -ankle_over_floor(target, foot, target_floor_) * kUp;
  const auto point = [&](double part) {
    return Sole{source_back * (part * source_ball * heading + source_down),
                target_back * (part * target_ball * heading + target_down),
                part * (target_ball - scale_ * source_ball)};
  };
  ball_ = point(1);
  heel_ = point(-0.3);  // behind the ankle, a typical proportion
  ahead_ = source_back * heading;
  sideways_ = source_back * kUp.cross(heading);
}

double LegPlacement::depth(std::span<const Transform> pose, const std::vector<Point>& points,
                           double floor) const {
  double deepest = std::numeric_limits<double>::max();
  for (const Point& point : points) {
    deepest = std::min(deepest, pose[at(point.joint)].position.y() - floor - point.height);
  }
  return deepest;
}

std::array<std::vector<double>, 2> LegPlacement::standing(const Clip& source,
                                                          std::span<const Contact> contacts) const {
  const int frames = source.frame_count();
  std::vector<double> near(at(frames)), still(at(frames), 0.0), upright(at(frames));
  for (const Contact& contact : contacts) {
    const bool own = std::ranges::any_of(
        source_points_, [&](const Point& point) { return point.joint == contact.joint; });
    if (!own) continue;
    const int last = std::min(frames - 1, static_cast<int>(std::floor(contact.end * source.rate)));
    for (auto f = static_cast<int>(std::ceil(contact.start * source.rate)); f <= last; ++f) {
      still[at(f)] = 1;
    }
  }
  std::vector<Transform> pose(source.skeleton.names.size());
  for (int f = 0; f < frames; ++f) {
    source.get_pose(f, pose);
    const double height = depth(pose, source_points_, source_floor_.motion) / leg_;
    near[at(f)] = std::max(1 - smooth_step(kNearFloor, kFarFromFloor, height), still[at(f)]);
    const Vec3 shank = pose[at(source_ankle_)].position - pose[at(source_knee_)].position;
    const double lean = kPi / 2 + elevation(shank);  // angle from straight down
    upright[at(f)] = 1 - smooth_step(60 * kRadiansPerDegree, 85 * kRadiansPerDegree, lean);
  }
  const int reach = softening_reach(source.rate);
  std::array<std::vector<double>, 2> result = {softened(near, reach), softened(still, reach)};
  for (std::vector<double>& weights : result) {
    for (std::size_t f = 0; f < weights.size(); ++f) weights[f] *= upright[f];
  }
  return result;
}

void LegPlacement::add_lack(std::span<const Transform> source_pose,
                            std::span<const Transform> target_pose, double standing, double bearing,
                            ShiftSolver& solver) const {
  if (!(bearing > 0)) return;
  const Vec3& ankle = target_pose[at(limb_.end())].position;
  const Vec3 along = (ankle - target_pose[at(limb_.upper())].position).stableNormalized();
  solver.add(bearing, along, 0, goal_of(source_pose, target_pose, standing) - ankle, {});
}

double LegPlacement::lack(std::span<const Transform> source_pose,
                          std::span<const Transform> target_pose, double standing) const {
  const auto place_of = [&](int joint) { return target_pose[at(joint)].position; };
  const Vec3 to_goal = goal_of(source_pose, target_pose, standing) - place_of(limb_.upper());
  // The present extension, or nearly the full length if that is more.
  const double reach =
      std::max((place_of(limb_.end()) - place_of(limb_.upper())).norm() * (1 + 1e-9),
               0.997 * ((place_of(limb_.lower()) - place_of(limb_.upper())).norm() +
                        (place_of(limb_.end()) - place_of(limb_.lower())).norm()));
  const double beside = flat(to_goal).squaredNorm();
  if (to_goal.norm() <= reach || to_goal.y() >= 0 || beside >= reach * reach) return 0;
  return standing * (-to_goal.y() - std::sqrt(reach * reach - beside));
}

Vec3 LegPlacement::goal_of(std::span<const Transform> source_pose,
                           std::span<const Transform> target_pose, double standing) const {
  const Vec3 ankle = target_pose[at(limb_.end())].position;
  const auto scaled = [&](const Vec3& point) {
    return Vec3(scale_ * point.x(),
                target_floor_.motion + scale_ * (point.y() - source_floor_.motion),
                scale_ * point.z());
  };

  const Transform& source_ankle = source_pose[at(source_ankle_)];
  const double rolled = -elevation(source_ankle.orientation * ahead_);
  const double on_ball = smooth_step(0, 6 * kRadiansPerDegree, rolled);
  // From the foot's lateral axis, because a foot rolling over its toes briefly points back.
  const Vec3 heading = flat((source_ankle.orientation * sideways_).cross(kUp)).stableNormalized();
  const auto ankle_over = [&](const Sole& sole) {
    return Vec3(scaled(source_ankle * sole.source) + sole.longer * heading -
                target_pose[at(limb_.end())].orientation * sole.target);
  };
  const Vec3 by_heel = ankle_over(heel_);
  Vec3 goal = by_heel + on_ball * (ankle_over(ball_) - by_heel);
  goal = ankle + standing * (goal - ankle);
  const double allowed =
      std::min(0.0, scale_ * depth(source_pose, source_points_, source_floor_.motion));
  const double lies =
      depth(target_pose, target_points_, target_floor_.motion) + goal.y() - ankle.y();
  if (lies < allowed) goal.y() += allowed - lies;
  return goal;
}

LegPlacement::Outcome LegPlacement::place(std::span<const Transform> source_pose,
                                          std::span<const Transform> local, double standing,
                                          double part, std::span<Transform> target_pose) const {
  const Vec3 way =
      goal_of(source_pose, target_pose, standing) - target_pose[at(limb_.end())].position;
  return limb_.move_end(part * way, local, target_pose);
}

}  // namespace krok::retarget
