#include "ragdoll/get_up.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/index.h"
#include "math/hermite.h"
#include "math/quaternion.h"
#include "motion/hips_root.h"
#include "motion/local_motion.h"
#include "motion/mirror.h"
#include "motion/sample.h"
#include "motion/travel.h"
#include "ragdoll/crouch_internal.h"

namespace krok::ragdoll {

namespace {

constexpr double kOverlap = 0.5;         // seconds in which the motion begins, at most
constexpr double kShortest = 0.65;       // seconds of the way there
constexpr double kToCrouch = 1.2;        // the same into a crouch, mostly turned over
constexpr double kLongestWay = 1.4;      // seconds
constexpr double kHelps = 0.85;          // of the acceleration of the try before
constexpr double kTooDeep = 0.3;         // metres in the ground
constexpr double kTravel = 0.6;          // metres/s of the root, at most
constexpr double kQuinticPeak = 5.7735;  // of its acceleration, for a way and time of 1
constexpr int kTries = 16;

// The same joints, and bones of the same lengths below the hips, as join() has it.
Status check_skeleton(const Skeleton& skeleton, const Clip& motion) {
  const Skeleton& other = motion.skeleton;
  const auto wrong = [](std::string message) {
    return Error("motion-skeleton", std::move(message),
                 "krok-retarget brings the motion to the other skeleton");
  };
  if (other.names != skeleton.names || other.parents != skeleton.parents) {
    return wrong("the motion has other joints than the one that falls");
  }
  const double extent = std::max(reference_height(skeleton), 1e-3);
  for (int j = 1; j < skeleton.joint_count(); ++j) {
    const double own = skeleton.reference_local(j).position.norm();
    const double others = other.reference_local(j).position.norm();
    if (skeleton.parents[at(j)] > 0 && std::abs(own - others) > 0.01 * extent) {
      return wrong(fmt::format("the bone above '{}' is {:.1f} cm long, not {:.1f} cm",
                               skeleton.names[at(j)], 100 * others, 100 * own));
    }
  }
  return {};
}

// Turn about the vertical and shift along the ground that bring `from` nearest to `to`.
struct OnGround {
  Transform move;
  double distance = 0;
};

// Points on the bodies, which tell a front from a back and a side, and what each weighs.
struct Cloud {
  std::vector<Vec3> points;
  std::vector<double> weights;
};

Cloud cloud_of(const std::vector<Body>& bodies, std::span<const Transform> pose) {
  Cloud cloud;
  double mass = 0;
  for (const Body& body : bodies) mass += body.mass;
  for (const Body& body : bodies) {
    const Shape& shape = body.shape;
    const double half = shape.kind == Shape::Kind::capsule ? shape.half_length : 0;
    const Vec3 reach = shape.kind == Shape::Kind::box
                           ? shape.half
                           : Vec3(Vec3::Constant(shape.radius) + half * Vec3::UnitY());
    const Transform to_world = pose[at(body.joint)] * body.to_joint;
    for (int i = 0; i < 6; ++i) {
      const double side = i < 3 ? 1 : -1;
      cloud.points.push_back(to_world * Vec3(side * reach[i % 3] * Vec3::Unit(i % 3)));
      cloud.weights.push_back(body.mass / mass / 6);
    }
  }
  return cloud;
}

OnGround nearest_on_ground(const Cloud& from, const Cloud& to) {
  Vec3 mean_from = Vec3::Zero(), mean_to = Vec3::Zero();
  for (std::size_t i = 0; i < from.points.size(); ++i) {
    mean_from += from.weights[i] * from.points[i];
    mean_to += from.weights[i] * to.points[i];
  }
  double across = 0, along = 0;
  for (std::size_t i = 0; i < from.points.size(); ++i) {
    const Vec3 a = from.points[i] - mean_from, b = to.points[i] - mean_to;
    along += from.weights[i] * (a.x() * b.x() + a.z() * b.z());
    across += from.weights[i] * (a.z() * b.x() - a.x() * b.z());
  }
  OnGround found;
  found.move.orientation = axis_rotation(Axis::y, std::atan2(across, along));
  found.move.position = mean_to - found.move.orientation * mean_from;
  found.move.position.y() = 0;
  double sum = 0;
  for (std::size_t i = 0; i < from.points.size(); ++i) {
    // The ground's height may be another.
    Vec3 off = found.move * from.points[i] - to.points[i];
    off.y() -= mean_from.y() - mean_to.y();
    sum += from.weights[i] * off.squaredNorm();
  }
  found.distance = std::sqrt(sum);
  return found;
}

std::vector<Transform> pose_of(const Clip& clip, int frame) {
  std::vector<Transform> pose(clip.skeleton.names.size());
  clip.get_pose(frame, pose);
  return pose;
}

// Angular accelerations of `joints` relative to their parents, of frames [begin, end).
std::vector<double> accelerations(const LocalMotion& motion, std::span<const int> joints, int begin,
                                  int end, double rate) {
  std::vector<double> found;
  for (const int j : joints) {
    const auto turns = motion.joint_orientations(j);
    const auto step = [&](int f) {
      return rotation_vector(turns[at(f)].conjugate() * turns[at(f + 1)]);
    };
    for (int f = std::max(begin, 1); f < std::min(end, motion.frames - 1); ++f) {
      found.push_back((step(f) - step(f - 1)).norm() * rate * rate);
    }
  }
  return found;
}

double percentile_99(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto place = static_cast<std::ptrdiff_t>(0.99 * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + place, values.end());
  return values[static_cast<std::size_t>(place)];
}

// The integral of smoother_step() from 0.
double eased_time(double u) {
  u = std::clamp(u, 0.0, 1.0);
  return u * u * u * u * (2.5 + u * (u - 3));
}

class Riser {
 public:
  // Both clips are rooted at the hips (HipsRoot), which may append joints after the first `joints`.
  Riser(const Clip& fall, int joints, int frame, Clip motion, const std::vector<Body>& bodies,
        const GetUpOptions& options)
      : fall_(fall),
        joints_(joints),
        frame_(frame),
        motion_(std::move(motion)),
        bodies_(bodies),
        options_(options) {
    if (!options_.ground) {
      options_.ground = [](double, double) { return std::optional<double>(0.0); };
    }
  }

  void place();
  // `shortest`: seconds of the way there.
  void run(double shortest, RisenClip& risen);

 private:
  double first_duration(double shortest) const;
  LocalMotion way(int frames, int overlap) const;

  const Clip& fall_;
  int joints_, frame_;
  Clip motion_;
  const std::vector<Body>& bodies_;
  GetUpOptions options_;
  std::vector<Transform> lying_, locals_;  // joint_to_world, joint_to_parent
  LocalMotion local_;                      // of the motion
  double limit_ = 0;
};

void Riser::place() {
  lying_ = pose_of(fall_, frame_);
  locals_ = lying_;
  for (int j = 1; j < fall_.joint_count(); ++j) {
    locals_[at(j)] = lying_[at(fall_.skeleton.parents[at(j)])].inverse() * lying_[at(j)];
  }
  Transform move =
      nearest_on_ground(cloud_of(bodies_, pose_of(motion_, 0)), cloud_of(bodies_, lying_)).move;
  const Vec3 root = lying_[at(bodies_.front().joint)].position;
  move.position.y() = options_.ground(root.x(), root.z()).value_or(0);
  move_clip(move, motion_);
  local_ = local_motion(motion_);
}

// Seconds for the way there, from the largest turn and the root's way.
double Riser::first_duration(double shortest) const {
  double turn = 0;
  for (int j = 0; j < joints_; ++j) {
    turn = std::max(turn, angle_between(locals_[at(j)].orientation, local_.at(j, 0).orientation));
  }
  const double travel = (locals_[0].position - local_.at(0, 0).position).norm();
  const double speed = 1.875 * travel / kTravel;
  return std::clamp(std::max(std::sqrt(kQuinticPeak * turn / limit_), speed), shortest,
                    kLongestWay);
}

// `frames` from the lying pose to the motion's frame overlap / 2, then the rest of the motion.
// `overlap` is even.
LocalMotion Riser::way(int frames, int overlap) const {
  LocalMotion way;
  way.joints = local_.joints;
  const int half = overlap / 2;
  way.frames = frames + local_.frames - half;
  const std::size_t count = at(way.joints) * at(way.frames);
  way.orientations.resize(count);
  way.positions.resize(count);
  std::vector<Transform> moving(at(way.joints)), scratch(3 * moving.size()), local(moving.size());
  for (int f = 0; f < way.frames; ++f) {
    const double u = static_cast<double>(f) / frames;
    const double since = static_cast<double>(f - frames + overlap) / std::max(1, overlap);
    const double time = f >= frames ? f - frames + half : overlap * eased_time(since);
    sample(motion_, time / motion_.rate, moving, scratch);
    const double left = 1 - smoother_step(u);
    for (int j = 0; j < way.joints; ++j) {
      const int parent = fall_.skeleton.parents[at(j)];
      Transform now = parent < 0 ? moving[at(j)] : moving[at(parent)].inverse() * moving[at(j)];
      if (left > 0) {
        const Transform first = local_.at(j, 0);
        const Quat off = first.orientation.conjugate() * locals_[at(j)].orientation;
        now.position += left * (locals_[at(j)].position - first.position);
        now.orientation = now.orientation * from_rotation_vector(left * rotation_vector(off));
      }
      way.set(j, f, now);
    }
  }
  return way;
}

void Riser::run(double shortest, RisenClip& risen) {
  const double rate = fall_.rate;
  // Of joints with bodies: fingers and end sites that keep still are no measure.
  std::vector<int> bodied, all(at(joints_));
  for (const Body& body : bodies_) bodied.push_back(body.joint);
  std::iota(all.begin(), all.end(), 0);
  const double typical = percentile_99(accelerations(local_, bodied, 0, local_.frames, rate));
  // A motion that stands still gives no measure.
  risen.motion_acceleration = std::max(typical, 1.0);
  limit_ = options_.max_acceleration * risen.motion_acceleration;
  double duration = first_duration(shortest);
  LocalMotion motion;
  int frames = 0;
  risen.acceleration = std::numeric_limits<double>::infinity();
  for (int attempt = 0; attempt < kTries; ++attempt) {
    const int longer = std::max(2, static_cast<int>(std::ceil(duration * rate)));
    int overlap = std::min(static_cast<int>(kOverlap * rate), longer / 2);
    overlap = std::min(overlap, local_.frames - 1);
    overlap -= overlap % 2;
    LocalMotion tried = way(longer, overlap);
    clear_ground(fall_.skeleton, bodies_, options_.ground, 0, rate, 0.08 * duration + 0.1, tried);
    const auto found = accelerations(tried, all, 0, longer + 1, rate);
    const double largest = found.empty() ? 0 : *std::ranges::max_element(found);
    // Accelerations fall with the square of the time, but for those that the motion begins with.
    if (largest <= kHelps * risen.acceleration) {
      risen.acceleration = largest;
      motion = std::move(tried);
      frames = longer;
    }
    if (largest <= limit_ || duration >= kLongestWay) break;
    duration = std::min(kLongestWay, duration * std::clamp(std::sqrt(largest / limit_), 1.08, 1.4));
  }
  risen.first_frame = frame_;
  risen.handover = frame_ + frames;
  Clip after;
  after.skeleton = fall_.skeleton;
  after.rate = rate;
  set_local_motion(motion, after);
  risen.clip.skeleton = fall_.skeleton;
  risen.clip.rate = rate;
  risen.clip.provenance = fall_.provenance;
  risen.clip.resize(frame_ + after.frame_count());
  for (int f = 0; f < risen.clip.frame_count(); ++f) {
    const Clip& from = f < frame_ ? fall_ : after;
    const int own = f < frame_ ? f : f - frame_;
    std::ranges::copy(from.frame_positions(own), risen.clip.frame_positions(f).begin());
    std::ranges::copy(from.frame_orientations(own), risen.clip.frame_orientations(f).begin());
    if (f < frame_) continue;
    const double depth = depth_in_ground(bodies_, pose_of(after, own), options_.ground);
    risen.depth = f == frame_ ? depth : std::max(risen.depth, depth);
  }
}

// What is beyond them is not a person who gets up.
Status check_bounds(const RisenClip& risen) {
  if (check(risen.clip) && risen.depth <= kTooDeep) return {};
  return Error("ragdoll-rise",
               fmt::format("getting up takes a body {:.1f} m into the ground, so that there is no "
                           "motion to write",
                           risen.depth),
               "another --get-up, which begins more as the body lies");
}

}  // namespace

Result<std::vector<RiseChoice>> choose_rise(const Clip& fall, int frame,
                                            std::span<const Clip> motions, const RoleMap& roles,
                                            const std::vector<Body>& bodies, bool mirror) {
  if (motions.empty()) return Error("ragdoll-rise", "there is no motion to get up with");
  const Cloud lying = cloud_of(bodies, pose_of(fall, frame));
  const MirrorPairs pairs = find_mirror_pairs(fall.skeleton, roles);
  std::vector<RiseChoice> choices;
  for (std::size_t m = 0; m < motions.size(); ++m) {
    const Clip& motion = motions[m];
    if (Status status = check_skeleton(fall.skeleton, motion); !status) {
      return std::move(status).error();
    }
    if (motion.frame_count() < 2) {
      return Error("ragdoll-rise", "a motion to get up with has fewer than two frames");
    }
    Clip first = motion;
    first.resize(1);
    RiseChoice choice;
    choice.motion = static_cast<int>(m);
    choice.distance = nearest_on_ground(cloud_of(bodies, pose_of(first, 0)), lying).distance;
    if (mirror) {
      const double other =
          nearest_on_ground(cloud_of(bodies, pose_of(krok::mirror(first, pairs), 0)), lying)
              .distance;
      if (other < choice.distance) {
        choice.distance = other;
        choice.mirrored = true;
      }
    }
    choices.push_back(choice);
  }
  return choices;
}

Result<RisenClip> get_up(const Clip& fall, int frame, std::span<const Clip> motions,
                         const RoleMap& roles, const std::vector<Body>& bodies,
                         const GetUpOptions& options) {
  std::vector<Clip> begun;
  for (const Clip& motion : motions) {
    const bool crouches = begins_standing(motion, roles) && check_skeleton(fall.skeleton, motion);
    auto made = crouches ? begun_in_crouch(motion, roles) : Result<Clip>(motion);
    if (!made) return made.error();
    begun.push_back(*std::move(made));
  }
  auto tried = choose_rise(fall, frame, begun, roles, bodies, options.mirror);
  if (!tried) return tried.error();
  RisenClip risen;
  risen.tried = std::move(*tried);
  risen.choice = *std::ranges::min_element(risen.tried, {}, &RiseChoice::distance);
  const std::size_t chosen = at(risen.choice.motion);
  risen.crouches = begun[chosen].frame_count() != motions[chosen].frame_count();
  auto motion = resample(begun[chosen], fall.rate);
  if (!motion) return motion.error();
  if (risen.choice.mirrored) *motion = mirror(*motion, find_mirror_pairs(fall.skeleton, roles));
  // A turn below a root that is elsewhere would carry the body away.
  const std::array<const Clip*, 2> clips = {&fall, &*motion};
  const HipsRoot hips_root(clips, carrying_joint(roles));
  const Clip lying = hips_root.rooted(fall);
  Riser riser(lying, fall.joint_count(), frame, hips_root.rooted(*motion), bodies, options);
  riser.place();
  riser.run(risen.crouches ? kToCrouch : kShortest, risen);
  risen.clip = hips_root.restored(risen.clip, fall.skeleton);
  for (int f = 0; f < frame; ++f) {
    std::ranges::copy(fall.frame_positions(f), risen.clip.frame_positions(f).begin());
    std::ranges::copy(fall.frame_orientations(f), risen.clip.frame_orientations(f).begin());
  }
  if (Status status = check_bounds(risen); !status) return std::move(status).error();
  return risen;
}

}  // namespace krok::ragdoll
