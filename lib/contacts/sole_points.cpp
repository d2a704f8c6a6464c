#include "contacts/sole_points.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "contacts/legs.h"
#include "math/window.h"
#include "motion/travel.h"

namespace krok {

namespace {

// Fractions of the leg, hip to ankle, which is 0.491 of the stature (Drillis and Contini).
constexpr double kAnkleHeight = 0.0794;
constexpr double kHeelBehind = 0.0733;
constexpr double kBallHeight = 0.0224;
constexpr double kBallForward = 0.147;
constexpr double kTipForward = 0.236;
constexpr double kTipHeight = 0.012;
constexpr double kLowestAnkle = 0.04, kHighestAnkle = 0.16;

constexpr double kStillSpeed = 0.17;    // leg lengths per second: 0.15 m/s for a leg of 0.86 m
constexpr double kJump = 0.1;           // leg lengths
constexpr double kLowest = 0.2;         // of all frames
constexpr int kMinFrames = 5;           // frames
constexpr double kShortestToes = 0.02;  // leg lengths

struct Leg : LegJoints {
  int tip = -1;
};

double apart(const Skeleton& skeleton, int a, int b) {
  return (skeleton.reference[static_cast<std::size_t>(a)].position -
          skeleton.reference[static_cast<std::size_t>(b)].position)
      .norm();
}

// The joint of `candidates` that is furthest from `from` in the reference pose, or -1.
int furthest(const Skeleton& skeleton, int from, const std::vector<int>& candidates) {
  int best = -1;
  for (const int joint : candidates) {
    if (best < 0 || apart(skeleton, from, joint) > apart(skeleton, from, best) + 1e-9) best = joint;
  }
  return best;
}

double length_of(const Skeleton& skeleton, const Leg& leg) {
  if (leg.upper < 0 || leg.lower < 0 || leg.foot < 0) return 0;
  return apart(skeleton, leg.upper, leg.lower) + apart(skeleton, leg.lower, leg.foot);
}

Leg find_leg(const Skeleton& skeleton, const RoleMap& roles, FootSide side) {
  Leg leg{leg_joints(roles, side)};
  leg.toes = -1;
  const auto ends_below = [&](int joint) {
    std::vector<int> ends;
    for (int j = joint + 1; j < skeleton.joint_count(); ++j) {
      if (skeleton.end_sites[static_cast<std::size_t>(j)] && is_below(skeleton, j, joint)) {
        ends.push_back(j);
      }
    }
    return ends;
  };
  if (leg.foot < 0) {
    if (leg.lower >= 0) leg.foot = furthest(skeleton, leg.lower, ends_below(leg.lower));
    return leg;
  }
  std::vector<int> toes = roles.joints(kLegRoles[static_cast<std::size_t>(side)].toes);
  std::erase_if(toes, [&](int j) { return !is_below(skeleton, j, leg.foot); });
  std::vector<int> beyond;
  for (const int joint : toes) {
    const bool branch = std::ranges::any_of(
        toes, [&](int other) { return other != joint && is_below(skeleton, joint, other); });
    if (branch || skeleton.end_sites[static_cast<std::size_t>(joint)]) {
      beyond.push_back(joint);
    } else if (leg.toes < 0) {
      leg.toes = joint;
    }
  }
  // With a toe joint, only end sites below it are the tip, not one of the heel.
  const std::vector<int> ends = ends_below(leg.toes >= 0 ? leg.toes : leg.foot);
  beyond.insert(beyond.end(), ends.begin(), ends.end());
  leg.tip = furthest(skeleton, leg.foot, beyond);
  if (leg.tip >= 0 && apart(skeleton, leg.foot, leg.tip) < 1e-6) leg.tip = -1;
  // Many exporters put an end site at the toe joint itself, which shows no tip.
  const bool at_toes =
      leg.tip >= 0 && leg.toes >= 0 &&
      apart(skeleton, leg.toes, leg.tip) < kShortestToes * length_of(skeleton, leg);
  if (at_toes) leg.tip = -1;
  return leg;
}

Vec3 position(const Clip& clip, int frame, int joint) {
  return clip.frame_positions(frame)[static_cast<std::size_t>(joint)].cast<double>();
}

// All frames but those that repeat the one before: a take that is held for seconds before its
// motion, a foot in the air, shows no more of the foot than one frame does.
std::vector<int> distinct_frames(const Clip& clip) {
  constexpr float kSame = 1e-5F;  // metres
  const auto same = [](const Vec3f& a, const Vec3f& b) { return (a - b).norm() < kSame; };
  std::vector<int> distinct;
  for (int f = 0; f < clip.frame_count(); ++f) {
    if (f > 0 && std::ranges::equal(clip.frame_positions(f), clip.frame_positions(f - 1), same)) {
      continue;
    }
    distinct.push_back(f);
  }
  return distinct;
}

// The frames in which the foot is probably flat; empty: use the reference pose.
std::vector<int> flat_frames(const Clip& clip, const Leg& leg, double leg_length) {
  const int frames = clip.frame_count();
  std::vector<int> flat;
  if (frames < kMinFrames) return flat;
  const int front = leg.toes >= 0 ? leg.toes : leg.tip >= 0 ? leg.tip : leg.foot;
  const int step = std::max(1, static_cast<int>(std::lround(clip.rate / 30)));
  const auto moved = [&](int joint, int frame) {
    const int from = std::max(0, frame - step), to = std::min(frames - 1, frame + step);
    return (position(clip, to, joint) - position(clip, from, joint)).norm() * clip.rate /
           std::max(1, to - from);
  };
  const std::vector<int> distinct = distinct_frames(clip);
  for (const int f : distinct) {
    if (std::max(moved(leg.foot, f), moved(front, f)) < kStillSpeed * leg_length) flat.push_back(f);
  }
  const auto height = [&](int f) {
    return position(clip, f, leg.foot).y() + position(clip, f, front).y();
  };
  if (static_cast<int>(flat.size()) < kMinFrames) {
    flat = distinct;
    std::ranges::stable_sort(flat, {}, height);
    flat.resize(std::max<std::size_t>(
        1, static_cast<std::size_t>(static_cast<double>(flat.size()) * kLowest)));
    std::ranges::sort(flat);
  }
  return flat;
}

// The up direction in a joint's frame while the foot is flat, the median over these frames.
Vec3 up_in(const Clip& clip, int joint, const std::vector<int>& flat, const UpOfGround& ground) {
  const Quat& reference = clip.skeleton.reference[static_cast<std::size_t>(joint)].orientation;
  const Vec3 at_reference = reference.conjugate() * Vec3::UnitY();
  if (flat.empty()) return at_reference;
  std::vector<Vec3> ups;
  for (const int frame : flat) {
    const Vec3 there = ground ? ground(position(clip, frame, joint)) : Vec3(Vec3::UnitY());
    ups.emplace_back(joint_at(clip, frame, joint).orientation.conjugate() * there);
  }
  const Vec3 up = median_point(ups);
  return up.norm() > 0.1 ? Vec3(up.normalized()) : at_reference;
}

// Position of a joint in another joint's frame while the foot is flat.
Vec3 place_in(const Clip& clip, int joint, int frame_joint, const std::vector<int>& flat) {
  const auto relative = [](const Vec3& at, const Vec3& origin, const Quat& turn) -> Vec3 {
    return turn.conjugate() * Vec3(at - origin);
  };
  if (flat.empty()) {
    const Transform& from = clip.skeleton.reference[static_cast<std::size_t>(frame_joint)];
    return relative(clip.skeleton.reference[static_cast<std::size_t>(joint)].position,
                    from.position, from.orientation);
  }
  std::vector<Vec3> places;
  for (const int frame : flat) {
    places.push_back(relative(position(clip, frame, joint), position(clip, frame, frame_joint),
                              joint_at(clip, frame, frame_joint).orientation));
  }
  return median_point(places);
}

// The forward direction in the foot joint's frame, perpendicular to `up`.
Vec3 forward_in(const Clip& clip, const Leg& leg, const Vec3& up, const std::vector<int>& flat) {
  const auto level = [&](const Vec3& v) -> Vec3 { return v - up * up.dot(v); };
  const int front = leg.tip >= 0 ? leg.tip : leg.toes;
  Vec3 forward = Vec3::Zero();
  if (front >= 0) forward = level(place_in(clip, front, leg.foot, flat));
  if (forward.norm() < 1e-4) {
    const auto foot = static_cast<std::size_t>(leg.foot);
    forward = level(clip.skeleton.reference[foot].orientation.conjugate() * Vec3::UnitZ());
  }
  return forward.norm() < 1e-4 ? Vec3(up.unitOrthogonal()) : Vec3(forward.normalized());
}

// Whether a reference pose stands flat on the ground at y = 0 on feet that are no person's in
// proportion, as boots on short legs: as steep as the feet of the motion, of which the front is
// `below` the ankle, so that it does not point its toes.
bool stands_on_high_ankles(const Skeleton& skeleton, const Leg& leg, int front, double length,
                           double below) {
  constexpr double kAlike = 0.08, kHighestFront = 0.2;  // leg lengths
  const double height = skeleton.reference[static_cast<std::size_t>(front)].position.y();
  const double ankle = skeleton.reference[static_cast<std::size_t>(leg.foot)].position.y();
  return std::abs(ankle - height - below) < kAlike * length && ankle > kHighestAnkle * length &&
         height >= 0 && height < kHighestFront * length;
}

std::vector<SolePoint> points_of(const Clip& clip, const Leg& leg, FootSide side, double length,
                                 const UpOfGround& ground) {
  std::vector<SolePoint> points;
  if (leg.foot < 0 || !(length > 0)) return points;
  if (clip.skeleton.end_sites[static_cast<std::size_t>(leg.foot)]) {
    points.push_back({side, FootPart::heel, leg.foot, Vec3::Zero(), true});
    return points;
  }
  std::vector<int> flat = flat_frames(clip, leg, length);
  Vec3 up = up_in(clip, leg.foot, flat, ground);
  double ankle = kAnkleHeight * length, above = kBallHeight * length;
  if (leg.toes >= 0 || leg.tip >= 0) {
    const int front = leg.toes >= 0 ? leg.toes : leg.tip;
    const double below = -up.dot(place_in(clip, front, leg.foot, flat));
    if (leg.toes < 0) above = kTipHeight * length;
    ankle = std::clamp(above + below, kLowestAnkle * length, kHighestAnkle * length);
    if (above + below > kHighestAnkle * length &&
        stands_on_high_ankles(clip.skeleton, leg, front, length, below)) {
      flat.clear();
      up = up_in(clip, leg.foot, flat, ground);
      const auto& reference = clip.skeleton.reference;
      ankle = reference[static_cast<std::size_t>(leg.foot)].position.y();
      above = reference[static_cast<std::size_t>(front)].position.y();
    }
  }
  const Vec3 forward = forward_in(clip, leg, up, flat);
  points.push_back(
      {side, FootPart::heel, leg.foot, -up * ankle - forward * (kHeelBehind * length), true});
  if (leg.toes >= 0) {
    points.push_back({side, FootPart::ball, leg.toes, Vec3::Zero(), false});
    // Toes bend, so the direction to their tip is taken from the foot.
    const Vec3 toes_up = up_in(clip, leg.toes, flat, ground);
    if (leg.tip >= 0) {
      points.push_back({side, FootPart::tip, leg.tip, Vec3::Zero(), false});
    } else {
      Vec3 ahead = forward;
      if (flat.empty()) {
        const auto at = [&](int j) {
          return clip.skeleton.reference[static_cast<std::size_t>(j)].orientation;
        };
        ahead = at(leg.toes).conjugate() * (at(leg.foot) * forward);
      } else {
        const int frame = flat[flat.size() / 2];
        ahead = joint_at(clip, frame, leg.toes).orientation.conjugate() *
                (joint_at(clip, frame, leg.foot).orientation * forward);
      }
      ahead -= toes_up * toes_up.dot(ahead);
      points.push_back(
          {side, FootPart::tip, leg.toes,
           ahead.normalized() * ((kTipForward - kBallForward) * length) - toes_up * above, true});
    }
    return points;
  }
  if (leg.tip >= 0) {
    const Vec3 end = place_in(clip, leg.tip, leg.foot, flat);
    const bool at_ball = forward.dot(end) < 0.5 * (kBallForward + kTipForward) * length;
    if (!at_ball) {
      points.push_back(
          {side, FootPart::ball, leg.foot, forward * (kBallForward * length) - up * ankle, true});
    }
    points.push_back(
        {side, at_ball ? FootPart::ball : FootPart::tip, leg.tip, Vec3::Zero(), false});
    return points;
  }
  points.push_back(
      {side, FootPart::ball, leg.foot, forward * (kBallForward * length) - up * ankle, true});
  return points;
}

}  // namespace

const char* name_of(FootSide side) {
  return side == FootSide::left ? "left" : "right";
}

const char* name_of(FootPart part) {
  return part == FootPart::heel ? "heel" : part == FootPart::ball ? "ball" : "tip";
}

Feet find_feet(const Clip& clip, const RoleMap& roles) {
  return find_feet(clip, roles, {});
}

Feet find_feet(const Clip& clip, const RoleMap& roles, const UpOfGround& up) {
  Feet feet;
  std::array<Leg, 2> legs;
  int with_length = 0;
  for (const FootSide side : {FootSide::left, FootSide::right}) {
    Leg& leg = legs[static_cast<std::size_t>(side)];
    leg = find_leg(clip.skeleton, roles, side);
    const double length = length_of(clip.skeleton, leg);
    if (length > 0) ++with_length;
    feet.leg_length += length;
  }
  if (with_length > 0) feet.leg_length /= with_length;
  for (const FootSide side : {FootSide::left, FootSide::right}) {
    const auto s = static_cast<std::size_t>(side);
    feet.points[s] = points_of(clip, legs[s], side, feet.leg_length, up);
  }
  return feet;
}

bool jumps_at_start(std::span<const Vec3> track, double leg_length) {
  if (track.size() <= 3) return false;
  const double after = std::max((track[2] - track[1]).norm(), (track[3] - track[2]).norm());
  return (track[1] - track[0]).norm() > 3 * after + kJump * leg_length;
}

std::vector<Vec3> track_of(const Clip& clip, const SolePoint& point, double leg_length) {
  std::vector<Vec3> track;
  track.reserve(static_cast<std::size_t>(clip.frame_count()));
  const bool at_joint = point.offset.isZero(0);
  for (int f = 0; f < clip.frame_count(); ++f) {
    track.push_back(at_joint ? position(clip, f, point.joint)
                             : joint_at(clip, f, point.joint) * point.offset);
  }
  if (jumps_at_start(track, leg_length)) track[0] = 2 * track[1] - track[2];
  return track;
}

double slide_speed(const Clip& clip, const RoleMap& roles) {
  const Feet feet = find_feet(clip, roles);
  std::vector<std::vector<Vec3>> tracks;
  for (const auto& points : feet.points) {
    for (const SolePoint& point : points) {
      tracks.push_back(track_of(clip, point, feet.leg_length));
    }
  }
  if (tracks.empty() || clip.frame_count() < 2) return 0;
  // A path that goes back to its start takes the feet along.
  std::vector<char> jumps(tracks.front().size(), 0);
  if (const int hips = roles.joint(Role::hips); hips >= 0) {
    for (const Jump& jump : jumps_of(clip, hips)) jumps[static_cast<std::size_t>(jump.frame)] = 1;
  }
  double way = 0;
  for (std::size_t f = 1; f < tracks.front().size(); ++f) {
    if (jumps[f] != 0) continue;
    double least = std::numeric_limits<double>::infinity();
    for (const auto& track : tracks) {
      const Vec3 moved = track[f] - track[f - 1];
      least = std::min(least, std::hypot(moved.x(), moved.z()));
    }
    way += least;
  }
  return way / clip.duration();
}

}  // namespace krok
