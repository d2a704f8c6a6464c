#include "retarget/foot_placement.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/index.h"
#include "ik/two_bone.h"
#include "math/quaternion.h"
#include "math/window.h"
#include "retarget/actor_view_internal.h"

namespace krok::retarget {

namespace {

std::vector<int> subtree(const Skeleton& skeleton, int root) {
  std::vector<int> joints = {root};
  std::vector<char> inside(skeleton.names.size(), 0);
  inside[at(root)] = 1;
  for (int j = root + 1; j < skeleton.joint_count(); ++j) {
    if (inside[at(skeleton.parents[at(j)])] == 0) continue;
    inside[at(j)] = 1;
    joints.push_back(j);
  }
  return joints;
}

double elevation(const Vec3& v) {
  const double length = v.norm();
  return length > 0 ? std::asin(std::clamp(v.y() / length, -1.0, 1.0)) : 0.0;
}

// A correction of a leg's ankle without what comes of rounding, which would move a straight leg's
// knee by its square root: none below a ten-thousandth of the leg, or a few steps of a float at
// `place`; all of it from ten times that.
Vec3 beyond_rounding(const Vec3& correction, double leg, const Vec3& place) {
  const double least =
      std::max(1e-4 * leg, 8 * std::numeric_limits<float>::epsilon() * place.norm());
  return smooth_step(least, 10 * least, correction.norm()) * correction;
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
  for (const int joint : subtree(actor.skeleton, actor.roles.joint(foot))) {
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
    for (const int joint : subtree(stance.skeleton, stance.roles.joint(foot))) {
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
  for (const int joint : subtree(actor.skeleton, ankle)) {
    points.push_back({joint, actor.pose[at(joint)].position.y() - floor});
  }
  return points;
}

std::optional<LegPlacement> LegPlacement::create(const Actor& source, const Actor& target,
                                                 std::span<const Quat> turns, double scale,
                                                 const Floor& source_floor,
                                                 const Floor& target_floor, bool is_left) {
  const auto& [upper, lower, foot, toes] = kLegRoles[is_left ? 0 : 1];
  LegPlacement leg;
  leg.scale_ = scale;
  leg.source_floor_ = source_floor;
  leg.target_floor_ = target_floor;
  leg.source_knee_ = source.roles.joint(lower);
  leg.source_ankle_ = source.roles.joint(foot);
  leg.upper_ = target.roles.joint(upper);
  leg.lower_ = target.roles.joint(lower);
  leg.ankle_ = target.roles.joint(foot);
  if (leg.source_ankle_ < 0 || leg.upper_ < 0 || leg.lower_ < 0 || leg.ankle_ < 0) {
    return std::nullopt;
  }
  const auto from = [&](int joint) { return source.pose[at(joint)].position; };
  const auto to = [&](int joint) { return target.pose[at(joint)].position; };

  leg.leg_ = (from(leg.source_knee_) - from(source.roles.joint(upper))).norm() +
             (from(leg.source_ankle_) - from(leg.source_knee_)).norm();
  leg.source_front_ = foot_front(source.skeleton, source.roles, foot);
  leg.find_soles(source, target, turns[at(leg.ankle_)], foot);

  // By default the knee's hinge points to the character's left.
  const Vec3 thigh = to(leg.lower_) - to(leg.upper_);
  const Vec3 left =
      to(target.roles.joint(Role::left_upper_leg)) - to(target.roles.joint(Role::right_upper_leg));
  const Vec3 square = left - thigh * (left.dot(thigh) / std::max(thigh.squaredNorm(), 1e-12));
  leg.hinge_ = target.pose[at(leg.upper_)].orientation.conjugate() * square.normalized();

  leg.source_points_ =
      points_of_foot(source, leg.source_ankle_, lowest_of_foot(source, foot) - source_floor.sole);
  leg.target_points_ =
      points_of_foot(target, leg.ankle_, lowest_of_foot(target, foot) - target_floor.sole);
  const std::vector<int> shank_joints = subtree(target.skeleton, leg.lower_);
  const std::vector<int> foot_joints = subtree(target.skeleton, leg.ankle_);
  for (const int joint : subtree(target.skeleton, leg.upper_)) {
    Follows follows = Follows::thigh;
    if (std::binary_search(shank_joints.begin(), shank_joints.end(), joint)) {
      follows = Follows::shank;
    }
    if (std::binary_search(foot_joints.begin(), foot_joints.end(), joint)) follows = Follows::foot;
    leg.links_.push_back({joint, target.skeleton.parents[at(joint)], follows});
  }
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
  const Quat target_back = (turn * target.pose[at(ankle_)].orientation).conjugate();
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

std::vector<double> LegPlacement::standing(const Clip& source) const {
  const int frames = source.frame_count();
  const auto place_of = [&](int frame, int joint) {
    const int known = std::clamp(frame, 0, frames - 1);
    return Vec3(source.frame_positions(known)[at(joint)].cast<double>());
  };
  // In leg lengths per second, over two frames; the slower of ankle and ball counts.
  const auto speed = [&](int frame, int joint) {
    return (place_of(frame + 1, joint) - place_of(frame - 1, joint)).norm() * 0.5 * source.rate /
           leg_;
  };
  std::vector<double> near(at(frames)), upright(at(frames));
  std::vector<Transform> pose(source.skeleton.names.size());
  for (int f = 0; f < frames; ++f) {
    double slowest = speed(f, source_ankle_);
    if (source_front_ >= 0) slowest = std::min(slowest, speed(f, source_front_));
    source.get_pose(f, pose);
    const double height = depth(pose, source_points_, source_floor_.motion) / leg_;
    near[at(f)] = std::max(1 - smooth_step(0.12, 0.3, height), 1 - smooth_step(0.25, 0.8, slowest));
    const Vec3 shank = place_of(f, source_ankle_) - place_of(f, source_knee_);
    const double lean = kPi / 2 + elevation(shank);  // angle from straight down
    upright[at(f)] = 1 - smooth_step(60 * kRadiansPerDegree, 85 * kRadiansPerDegree, lean);
  }
  std::vector<double> result = softened(near, softening_reach(source.rate));
  for (std::size_t f = 0; f < result.size(); ++f) result[f] *= upright[f];
  return result;
}

double LegPlacement::lack(std::span<const Transform> source_pose,
                          std::span<const Transform> target_pose, double standing) const {
  const auto place_of = [&](int joint) { return target_pose[at(joint)].position; };
  const Vec3 to_goal = goal_of(source_pose, target_pose, standing) - place_of(upper_);
  // The present extension, or nearly the full length if that is more.
  const double reach = std::max((place_of(ankle_) - place_of(upper_)).norm() * (1 + 1e-9),
                                0.997 * ((place_of(lower_) - place_of(upper_)).norm() +
                                         (place_of(ankle_) - place_of(lower_)).norm()));
  const double beside = flat(to_goal).squaredNorm();
  if (to_goal.norm() <= reach || to_goal.y() >= 0 || beside >= reach * reach) return 0;
  return standing * (-to_goal.y() - std::sqrt(reach * reach - beside));
}

Vec3 LegPlacement::goal_of(std::span<const Transform> source_pose,
                           std::span<const Transform> target_pose, double standing) const {
  const Vec3 ankle = target_pose[at(ankle_)].position;
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
                target_pose[at(ankle_)].orientation * sole.target);
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
                                          std::span<Transform> target_pose) const {
  const Vec3 root = target_pose[at(upper_)].position;
  const Vec3 knee = target_pose[at(lower_)].position;
  const Vec3 ankle = target_pose[at(ankle_)].position;
  const Vec3 upper_bone = knee - root;
  const Vec3 lower_bone = ankle - knee;
  const double length = upper_bone.norm() + lower_bone.norm();
  Outcome outcome;
  const Vec3 correction =
      beyond_rounding(goal_of(source_pose, target_pose, standing) - ankle, length, ankle);
  outcome.correction = correction.norm();
  if (outcome.correction == 0) return outcome;
  const Vec3 goal = ankle + correction;
  // What keeps a knee from snapping also bends a straight one: in proportion to small corrections,
  // so that a leg that needs none is continued by one that does.
  const double soft = std::min(1.0, outcome.correction / (0.01 * length));

  // The direction of the knee: its present one if bent, from its hinge if straight.
  const Vec3 line = (ankle - root).stableNormalized();
  const Vec3 by_hinge = line.cross(target_pose[at(upper_)].orientation * hinge_).stableNormalized();
  const Vec3 bent = upper_bone - line * line.dot(upper_bone);
  // The direction of a knee within 25 degrees of straight is unreliable.
  const double straight = 1 - smooth_step(0.05 * length, 0.11 * length, bent.norm());
  const Vec3 outward = bent + soft * (0.005 + 0.06 * straight) * length * by_hinge;
  TwoBoneChain chain{root, knee, ankle, outward.cross(line)};
  TwoBoneGoal to_reach;
  to_reach.target = goal;
  to_reach.pole = (goal - root).cross(chain.hinge);
  to_reach.softness = soft * 0.003 * length;
  const TwoBoneSolution solution = solve_two_bone(chain, to_reach);
  outcome.miss = (solution.end - goal).norm();

  for (const Link& link : links_) {
    Transform& transform = target_pose[at(link.joint)];
    if (link.follows == Follows::thigh) {
      transform.orientation = (solution.root_rotation * transform.orientation).normalized();
    } else if (link.follows == Follows::shank) {
      transform.orientation = (solution.middle_rotation * transform.orientation).normalized();
    }
    if (link.joint == upper_) continue;
    transform.position = target_pose[at(link.parent)] * local[at(link.joint)].position;
  }
  return outcome;
}

}  // namespace krok::retarget
