#include "ragdoll/get_up.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/index.h"
#include "math/hermite.h"
#include "math/quaternion.h"
#include "math/window.h"

namespace krok::ragdoll {

namespace {

constexpr double kLeft = 0.003, kDone = 0.005;     // metres that may stay in the ground
constexpr double kStays = 0.003;                   // metres that a lift leaves
constexpr double kFadeIn = 0.25, kLiftSpan = 0.2;  // seconds
constexpr int kRounds = 50;
constexpr double kGain = 1.5;      // of a round: smoothing takes some of it away
constexpr double kMaxTurn = 0.35;  // radians in a round

// The points of a shape that may be its lowest, world.
struct LowPoints {
  std::array<Vec3, 8> points;
  std::size_t count = 0;
};

LowPoints low_points(const Shape& shape, const Transform& to_world) {
  LowPoints low;
  if (shape.kind == Shape::Kind::box) {
    for (std::size_t i = 0; i < 8; ++i) {
      const Vec3 signs((i & 1) != 0 ? 1 : -1, (i & 2) != 0 ? 1 : -1, (i & 4) != 0 ? 1 : -1);
      low.points[low.count++] = to_world * signs.cwiseProduct(shape.half);
    }
    return low;
  }
  const Vec3 down = shape.radius * Vec3::UnitY();
  const double half = shape.kind == Shape::Kind::capsule ? shape.half_length : 0;
  for (const double end : {-half, half}) {
    low.points[low.count++] = to_world * Vec3(0, end, 0) - down;
  }
  return low;
}

struct Deepest {
  double depth = -std::numeric_limits<double>::infinity();
  Vec3 point = Vec3::Zero();
};

Deepest deepest(const Body& body, const Transform& joint_to_world, const GroundHeight& ground) {
  Deepest found;
  const LowPoints low = low_points(body.shape, joint_to_world * body.to_joint);
  for (std::size_t i = 0; i < low.count; ++i) {
    const auto height = ground(low.points[i].x(), low.points[i].z());
    if (!height) continue;
    const double depth = *height - low.points[i].y();
    if (depth > found.depth) found = {depth, low.points[i]};
  }
  return found;
}

// The turn about `pivot` that raises `point` by `rise`, as far as it can; a rotation vector.
Vec3 raising_turn(const Vec3& pivot, const Vec3& point, double rise) {
  const Vec3 arm = point - pivot;
  const double across = std::hypot(arm.x(), arm.z()), length = arm.norm();
  if (!(across > 1e-6)) return Vec3::Zero();
  const double now = std::atan2(arm.y(), across);
  const double wanted = std::asin(std::clamp((arm.y() + rise) / length, -1.0, 1.0));
  const Vec3 axis = Vec3(arm.x(), 0, arm.z()).cross(Vec3(Vec3::UnitY())).normalized();
  return std::clamp(wanted - now, 0.0, kMaxTurn) * axis;
}

// A Gaussian of `sigma` frames; beyond the ends there is nothing.
void smooth_over_time(std::vector<Vec3>& values, double sigma) {
  const int reach = std::max(1, static_cast<int>(std::ceil(3 * sigma)));
  std::vector<double> weights;
  double sum = 0;
  for (int k = -reach; k <= reach; ++k) {
    weights.push_back(std::exp(-0.5 * k * k / (sigma * sigma)));
    sum += weights.back();
  }
  const std::vector<Vec3> before = values;
  const int count = static_cast<int>(values.size());
  for (int i = 0; i < count; ++i) {
    Vec3 mean = Vec3::Zero();
    for (int k = -reach; k <= reach; ++k) {
      if (i + k >= 0 && i + k < count) mean += weights[at(k + reach)] * before[at(i + k)];
    }
    values[at(i)] = mean / sum;
  }
}

class GroundClearer {
 public:
  GroundClearer(const Skeleton& skeleton, const std::vector<Body>& bodies,
                const GroundHeight& ground, int begin, double rate, LocalMotion& motion)
      : skeleton_(skeleton),
        bodies_(bodies),
        ground_(ground),
        begin_(begin),
        rate_(rate),
        motion_(motion),
        turns_(bodies.size(), std::vector<Vec3>(at(motion.frames - begin), Vec3::Zero())) {}

  // What each body lacks, [bodies][frames]; the largest depth.
  double find_turns();
  void apply(double smoothing);
  // Lifts the whole body by what turns have left in the ground.
  void lift();

 private:
  Transform place(std::span<const Transform> pose, int joint, int frame) const {
    const int parent = skeleton_.parents[at(joint)];
    const Transform local = motion_.at(joint, frame);
    return parent < 0 ? local : pose[at(parent)] * local;
  }

  const Skeleton& skeleton_;
  const std::vector<Body>& bodies_;
  const GroundHeight& ground_;
  int begin_;
  double rate_;
  LocalMotion& motion_;
  std::vector<std::vector<Vec3>> turns_;
};

double GroundClearer::find_turns() {
  double largest = 0;
  std::vector<int> body_of(skeleton_.names.size(), -1);
  for (std::size_t b = 0; b < bodies_.size(); ++b)
    body_of[at(bodies_[b].joint)] = static_cast<int>(b);
  std::vector<Transform> pose(skeleton_.names.size());
  for (int f = begin_; f < motion_.frames; ++f) {
    const double since = (f - begin_) / rate_ / kFadeIn;
    const double fade = std::clamp(since * since * (3 - 2 * since), 0.0, 1.0);
    const std::size_t row = at(f - begin_);
    for (int j = 0; j < skeleton_.joint_count(); ++j) {
      pose[at(j)] = place(pose, j, f);
      const int b = body_of[at(j)];
      if (b < 0) continue;
      Vec3& turn = turns_[at(b)][row];
      turn.setZero();
      const Deepest low = deepest(bodies_[at(b)], pose[at(j)], ground_);
      const double depth = since >= 1 ? low.depth : fade * low.depth;
      if (!(depth > kLeft)) continue;
      largest = std::max(largest, depth);
      if (b == 0) {
        turn = Vec3(0, depth, 0);
        pose[at(j)].position += turn;
        continue;
      }
      const Vec3 world = raising_turn(pose[at(j)].position, low.point, depth);
      // In the parent's frame, with which it goes along.
      const int parent = skeleton_.parents[at(j)];
      turn = pose[at(parent)].orientation.conjugate() * world;
      pose[at(j)].orientation = from_rotation_vector(world) * pose[at(j)].orientation;
    }
  }
  return largest;
}

void GroundClearer::apply(double smoothing) {
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    if (std::ranges::all_of(turns_[b], [](const Vec3& turn) { return turn.isZero(); })) continue;
    smooth_over_time(turns_[b], std::max(1.0, smoothing * rate_));
    for (int f = begin_; f < motion_.frames; ++f) {
      const double fade = smoother_step((f - begin_) / rate_ / kFadeIn);
      const Vec3 turn = kGain * fade * turns_[b][at(f - begin_)];
      const int joint = b == 0 ? 0 : bodies_[b].joint;  // the root is in the world's frame
      Transform local = motion_.at(joint, f);
      if (b == 0) {
        local.position += turn;
      } else {
        local.orientation = (from_rotation_vector(turn) * local.orientation).normalized();
      }
      motion_.set(joint, f, local);
    }
  }
}

void GroundClearer::lift() {
  std::vector<double> needs;
  std::vector<Transform> pose(skeleton_.names.size());
  for (int f = begin_; f < motion_.frames; ++f) {
    for (int j = 0; j < skeleton_.joint_count(); ++j) pose[at(j)] = place(pose, j, f);
    needs.push_back(std::max(0.0, depth_in_ground(bodies_, pose, ground_) - kStays));
  }
  // The mean of a maximum over the same span is nowhere less.
  const int reach = std::max(1, static_cast<int>(std::lround(kLiftSpan * rate_ / 2)));
  needs = max_within(needs, 2 * reach);
  for (int round = 0; round < 2; ++round) needs = mean_within(needs, reach);
  for (int f = begin_; f < motion_.frames; ++f) {
    Transform root = motion_.at(0, f);
    root.position.y() += smoother_step((f - begin_) / rate_ / kFadeIn) * needs[at(f - begin_)];
    motion_.set(0, f, root);
  }
}

}  // namespace

double depth_in_ground(const Body& body, std::span<const Transform> pose,
                       const GroundHeight& ground) {
  return deepest(body, pose[at(body.joint)], ground).depth;
}

double depth_in_ground(const std::vector<Body>& bodies, std::span<const Transform> pose,
                       const GroundHeight& ground) {
  double depth = -std::numeric_limits<double>::infinity();
  for (const Body& body : bodies) depth = std::max(depth, depth_in_ground(body, pose, ground));
  return depth;
}

void clear_ground(const Skeleton& skeleton, const std::vector<Body>& bodies,
                  const GroundHeight& ground, int begin, double rate, double smoothing,
                  LocalMotion& motion) {
  if (begin >= motion.frames) return;
  GroundClearer clearer(skeleton, bodies, ground, begin, rate, motion);
  for (int round = 0; round < kRounds && clearer.find_turns() > kDone; ++round) {
    clearer.apply(smoothing);
  }
  clearer.lift();
}

}  // namespace krok::ragdoll
