#include "samples/generator/rise.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/index.h"
#include "ik/two_bone.h"
#include "math/quaternion.h"
#include "samples/generator/curves.h"
#include "samples/generator/rise_keys.h"
#include "samples/generator/walk.h"

namespace krok::samples {

namespace {

constexpr double kStature = 1.75;       // of the keys
constexpr double kSpacing = 1.0 / 240;  // seconds between the keys of the curves
constexpr double kSmoothing = 0.07;     // seconds, standard deviation
constexpr double kSettling = 0.7;       // seconds in which the pose becomes the stance

// A curve through values at uneven times that does not overshoot: monotone cubics (Fritsch and
// Carlson 1980), smoothed so that accelerations do not jump. What stays equal, stays.
Spline<double> curve_through(std::span<const double> times, std::span<const double> values,
                             double pace) {
  const std::size_t n = times.size();
  std::vector<double> slopes(n, 0.0);
  for (std::size_t i = 1; i + 1 < n; ++i) {
    const double before = (values[i] - values[i - 1]) / (times[i] - times[i - 1]);
    const double after = (values[i + 1] - values[i]) / (times[i + 1] - times[i]);
    if (before * after > 0) slopes[i] = 2 * before * after / (before + after);
  }
  std::vector<double> keys;
  std::size_t cell = 0;
  for (double time = 0; time < times.back() + kSpacing; time += kSpacing) {
    while (cell + 2 < n && time > times[cell + 1]) ++cell;
    const double width = times[cell + 1] - times[cell];
    const double u = std::clamp((time - times[cell]) / width, 0.0, 1.0);
    const double v = 1 - u;
    keys.push_back(values[cell] * v * v * (1 + 2 * u) + values[cell + 1] * u * u * (1 + 2 * v) +
                   width * u * v * (slopes[cell] * v - slopes[cell + 1] * u));
  }
  smooth(keys, kSmoothing / kSpacing);
  return {std::move(keys), 0, kSpacing / pace};
}

class Curves {
 public:
  Curves(std::span<const RiseKey> keys, double pace) {
    std::vector<std::vector<double>> columns;
    std::vector<double> times;
    for (const RiseKey& key : keys) {
      std::vector<double> row;
      const auto add = [&](const Vec3& v) { row.insert(row.end(), {v.x(), v.y(), v.z()}); };
      add(key.pelvis);
      row.insert(row.end(), {key.pitch, key.turn, key.spine, key.head});
      for (const auto* limbs : {&key.hands, &key.feet}) {
        for (const LimbKey& limb : *limbs) {
          add(limb.place);
          add(limb.pole);
          row.insert(row.end(), {limb.hangs, limb.pitch});
        }
      }
      columns.resize(row.size());
      for (std::size_t i = 0; i < row.size(); ++i) columns[i].push_back(row[i]);
      times.push_back(key.time);
    }
    for (const auto& column : columns) curves_.push_back(curve_through(times, column, pace));
  }

  RiseKey at(double time) const {
    std::size_t next = 0;
    const auto number = [&] { return curves_[next++](time); };
    const auto vector = [&] {
      const double x = number(), y = number(), z = number();
      return Vec3(x, y, z);
    };
    RiseKey key;
    key.pelvis = vector();
    for (double* value : {&key.pitch, &key.turn, &key.spine, &key.head}) *value = number();
    for (auto* limbs : {&key.hands, &key.feet}) {
      for (LimbKey& limb : *limbs) {
        limb.place = vector();
        limb.pole = vector();
        limb.hangs = number();
        limb.pitch = number();
      }
    }
    return key;
  }

 private:
  std::vector<Spline<double>> curves_;
};

class RisePoser {
 public:
  RisePoser(const Actor& actor, double scale) : actor_(actor), scale_(scale) {}
  std::vector<Transform> pose(const RiseKey& key) const;

 private:
  using World = std::vector<Transform>;
  void place(World& world, int joint, const Quat& orientation) const {
    const int parent = actor_.skeleton.parents[at(joint)];
    world[at(joint)] = {world[at(parent)] * actor_.skeleton.reference_local(joint).position,
                        orientation};
  }
  void pose_arm(Side side, const LimbKey& key, World& world) const;
  void pose_leg(Side side, const LimbKey& key, World& world) const;

  const Actor& actor_;
  double scale_;
};

Quat pitched_by(double degrees) {
  return axis_rotation(Axis::x, degrees * kRadiansPerDegree);
}

// Bones that lie along the side's x in the reference pose.
void RisePoser::pose_arm(Side side, const LimbKey& key, World& world) const {
  const ArmJoints& arm = actor_.arms[at(static_cast<int>(side))];
  const double sign = side_sign(side);
  const Quat chest = world[at(actor_.spine2)].orientation;
  place(world, arm.collar, chest);
  place(world, arm.upper, chest);
  const auto& reference = actor_.skeleton.reference;
  const Vec3 root = world[at(arm.upper)].position;
  const double upper =
      (reference[at(arm.lower)].position - reference[at(arm.upper)].position).norm();
  const double lower =
      (reference[at(arm.hand)].position - reference[at(arm.lower)].position).norm();
  // The arm as it is when it points to the target with the elbow's hinge across the pole, so that
  // the solution only bends it.
  const Vec3 target = scale_ * key.place;
  const Vec3 along = (target - root).normalized();
  const Vec3 out = (key.pole - key.pole.dot(along) * along).normalized();
  TwoBoneChain chain;
  chain.root = root;
  chain.middle = root + upper * along;
  chain.end = chain.middle + lower * along;
  chain.hinge = out.cross(along);
  const TwoBoneSolution solved =
      solve_two_bone(chain, {.target = target, .pole = key.pole, .softness = 0.03 * scale_});
  // The hinge of an elbow is about y in the reference pose: -y for the left, as it bends forwards.
  Mat3 axes;
  axes.col(0) = sign * along;
  axes.col(1) = -sign * chain.hinge;
  axes.col(2) = axes.col(0).cross(axes.col(1));
  const Quat straight(axes);
  world[at(arm.upper)].orientation = solved.root_rotation * straight;
  world[at(arm.lower)] = {solved.middle, solved.middle_rotation * straight};
  const Quat hanging = world[at(arm.lower)].orientation;
  // Flat on the ground, fingers forwards.
  const Quat flat = axis_rotation(Axis::y, -sign * kPi / 2);
  place(world, arm.hand, slerp(flat, hanging, std::clamp(key.hangs, 0.0, 1.0)));
  place(world, arm.fingers,
        world[at(arm.hand)].orientation *
            axis_rotation(Axis::z, -sign * 24 * kRadiansPerDegree * key.hangs));
}

void RisePoser::pose_leg(Side side, const LimbKey& key, World& world) const {
  const LegJoints& leg = actor_.legs[at(static_cast<int>(side))];
  const double hangs = std::clamp(key.hangs, 0.0, 1.0);
  const Quat on_ground = pitched_by(key.pitch);
  const Quat hips = world[at(actor_.hips)].orientation;
  place(world, leg.upper, hips);
  const Vec3 target = scale_ * key.place - (1 - hangs) * (on_ground * actor_.ball);
  TwoBoneChain chain;
  chain.root = world[at(leg.upper)].position;
  const Vec3 along = (target - chain.root).normalized();
  const Vec3 out = (key.pole - key.pole.dot(along) * along).normalized();
  chain.middle = chain.root + actor_.thigh * along;
  chain.end = chain.middle + actor_.shank * along;
  chain.hinge = out.cross(along);
  const TwoBoneSolution solved =
      solve_two_bone(chain, {.target = target, .pole = key.pole, .softness = 0.03 * scale_});
  Mat3 axes;
  axes.col(0) = chain.hinge;
  axes.col(1) = -along;
  axes.col(2) = axes.col(0).cross(axes.col(1));
  const Quat straight(axes);
  world[at(leg.upper)].orientation = solved.root_rotation * straight;
  world[at(leg.lower)] = {solved.middle, solved.middle_rotation * straight};
  const Quat pointed = world[at(leg.lower)].orientation * pitched_by(key.pitch);
  place(world, leg.foot, slerp(on_ground, pointed, hangs));
  // Toes on the ground stay flat while the heel is up.
  const double bent = (1 - hangs) * std::clamp(key.pitch, 0.0, 90.0);
  place(world, leg.toes, world[at(leg.foot)].orientation * pitched_by(-bent));
}

std::vector<Transform> RisePoser::pose(const RiseKey& key) const {
  std::vector<Transform> world(actor_.skeleton.names.size());
  const Quat hips = pitched_by(key.pitch) * axis_rotation(Axis::y, key.turn * kRadiansPerDegree);
  world[at(actor_.hips)] = {scale_ * key.pelvis, hips};
  place(world, actor_.spine, hips * pitched_by(0.3 * key.spine));
  place(world, actor_.spine1, hips * pitched_by(0.65 * key.spine));
  place(world, actor_.spine2, hips * pitched_by(key.spine));
  const Quat chest = world[at(actor_.spine2)].orientation;
  place(world, actor_.neck, chest * pitched_by(0.5 * key.head));
  place(world, actor_.head, chest * pitched_by(key.head));
  for (const Side side : {Side::left, Side::right}) {
    const std::size_t s = at(static_cast<int>(side));
    pose_arm(side, key.hands[s], world);
    pose_leg(side, key.feet[s], world);
  }
  for (int j = 0; j < actor_.skeleton.joint_count(); ++j) {
    if (actor_.skeleton.end_sites[at(j)] == 0) continue;
    place(world, j, world[at(actor_.skeleton.parents[at(j)])].orientation);
  }
  return world;
}

// Brings a pose to the stance by rotations relative to the parent.
void bring_to(const Skeleton& skeleton, std::span<const Transform> stance, double part,
              std::vector<Transform>& world) {
  std::vector<Transform> mixed(world.size());
  for (int j = 0; j < skeleton.joint_count(); ++j) {
    const int parent = skeleton.parents[at(j)];
    if (parent < 0) {
      mixed[at(j)] = {
          world[at(j)].position + part * (stance[at(j)].position - world[at(j)].position),
          slerp(world[at(j)].orientation, stance[at(j)].orientation, part)};
      continue;
    }
    const Transform a = world[at(parent)].inverse() * world[at(j)];
    const Transform b = stance[at(parent)].inverse() * stance[at(j)];
    mixed[at(j)] =
        mixed[at(parent)] * Transform{a.position, slerp(a.orientation, b.orientation, part)};
  }
  world = std::move(mixed);
}

Status check(const RiseOptions& options) {
  const auto within = [](double value, double least, double most) {
    return value >= least && value <= most;
  };
  if (within(options.stature, 0.5, 2.5) && within(options.pace, 0.25, 4) &&
      within(options.rate, 1, 1000)) {
    return {};
  }
  return Error("rise-option",
               "the stature is not from 0.5 to 2.5 m, the pace from 0.25 to 4 or the rate from 1 "
               "to 1000");
}

}  // namespace

Result<Clip> make_rise(const RiseOptions& options) {
  if (Status status = check(options); !status) return status.error();
  const auto standing = make_standing_actor(options.stature);
  if (!standing) return standing.error();
  const auto& [actor, stance] = *standing;
  const double scale = options.stature / kStature;
  // From where it lies to where it stands: the stance is where the walk begins.
  const std::span<const RiseKey> keys = rise_keys(options.from);
  const LegJoints& right = actor.legs[1];
  const Vec3 ankle = scale * keys.back().feet[1].place - actor.ball;
  const Vec3 there(0, 0, stance[at(right.foot)].position.z() - ankle.z());

  const Curves curves(keys, options.pace);
  const RisePoser poser(actor, scale);
  const double duration = keys.back().time / options.pace;
  Clip clip;
  clip.skeleton = actor.skeleton;
  clip.rate = options.rate;
  clip.resize(static_cast<int>(std::floor(duration * options.rate + 1e-6)) + 1);
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    const double time = duration * frame / std::max(1, clip.frame_count() - 1);
    std::vector<Transform> world = poser.pose(curves.at(time));
    for (Transform& joint : world) joint.position += there;
    const double settling = kSettling / options.pace;
    bring_to(clip.skeleton, stance, ease((time - duration + settling) / settling), world);
    clip.set_pose(frame, world);
  }
  return clip;
}

}  // namespace krok::samples
