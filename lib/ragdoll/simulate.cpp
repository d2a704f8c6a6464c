#include "ragdoll/simulate.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "core/index.h"
#include "math/quaternion.h"
#include "motion/sample.h"
#include "ragdoll/motion_follower.h"

namespace krok::ragdoll {

namespace {

constexpr double kLongest = 600;                // seconds
constexpr double kStill = 0.025, kTurn = 0.15;  // metres, radians
constexpr double kRest = 0.5;                   // seconds

constexpr double kFarthest = 1e4;  // metres from where the fall begins
constexpr double kSettling = 0.2;  // seconds
constexpr double kBlend = 0.5;     // seconds from the simulation to the motion that goes on

// J/kg. A sprinter of 12.3 m/s has 76 (Graubner and Nixdorf 2011), and some more in the limbs.
constexpr double kMaxEnergy = 120;

using Pose = std::vector<Transform>;

class FallMaker {
 public:
  FallMaker(const Clip& motion, const RoleMap& roles, const std::vector<Body>& bodies,
            const FallOptions& options)
      : motion_(motion), roles_(roles), bodies_(bodies), options_(options) {}

  Status begin(const ik::Limits& limits);
  Status run();
  Fall take() { return std::move(fall_); }

 private:
  std::vector<BodyState> start_states() const;
  void leave_out_jumps(std::vector<BodyState>& states);
  Surroundings moved_ground() const;
  void apply_pushes(int step);
  bool step(int number);
  void measure_off();
  Pose pose() const;
  bool is_in_bounds() const;
  void copy_animated();
  void add_frames(double from, double to, const Pose& before, const Pose& after);

  const Clip& motion_;
  const RoleMap& roles_;
  const std::vector<Body>& bodies_;
  const FallOptions& options_;
  Pose start_, locals_;
  std::vector<bool> slides_;  // bodies whose place the skeleton does not give
  // The world's origin is below the character, as Bullet computes in single precision.
  Vec3 origin_ = Vec3::Zero();
  World world_{WorldOptions(), Surroundings()};
  std::optional<MotionFollower> follower_;
  std::vector<int> carriers_;  // body_of_joint()
  Fall fall_;
  int frames_ = 0, next_frame_ = 0;
  std::vector<Transform> still_;  // bodies where they have been since then
  double still_since_ = -1;
};

std::vector<BodyState> FallMaker::start_states() const {
  const double frame = 1 / motion_.rate;
  const double before = std::max(0.0, options_.at - frame);
  const double after = std::min(motion_.duration(), options_.at + frame);
  const Pose first = pose_at(motion_, before), last = pose_at(motion_, after);
  const double span = after - before;
  std::vector<BodyState> states;
  for (const Body& body : bodies_) {
    BodyState state;
    state.to_world = start_[at(body.joint)] * body.to_joint;
    state.to_world.position -= origin_;
    if (span > 0) {
      const Transform a = first[at(body.joint)] * body.to_joint;
      const Transform b = last[at(body.joint)] * body.to_joint;
      state.velocity = (b.position - a.position) / span;
      state.spin = rotation_vector(b.orientation * a.orientation.conjugate()) / span;
    }
    states.push_back(state);
  }
  return states;
}

// Impossible speeds are those between unrelated frames, such as a T-pose before a motion.
void FallMaker::leave_out_jumps(std::vector<BodyState>& states) {
  double energy = 0, mass = 0;
  for (std::size_t b = 0; b < states.size(); ++b) {
    energy += 0.5 * bodies_[b].mass * states[b].velocity.squaredNorm();
    mass += bodies_[b].mass;
  }
  fall_.jumps = !(energy <= kMaxEnergy * mass);
  if (!fall_.jumps) return;
  for (BodyState& state : states) state.velocity = state.spin = Vec3::Zero();
}

Surroundings FallMaker::moved_ground() const {
  Surroundings ground = options_.surroundings;
  ground.height -= origin_.y();
  for (auto& triangle : ground.triangles) {
    for (Vec3& corner : triangle) corner -= origin_;
  }
  return ground;
}

Status FallMaker::begin(const ik::Limits& limits) {
  start_ = pose_at(motion_, options_.at);
  locals_.resize(start_.size());
  world_to_local(motion_.skeleton.parents, start_, locals_);
  origin_ = start_[at(bodies_.front().joint)].position;
  origin_.y() = 0;
  world_ = World(options_.world, moved_ground());
  std::vector<Joint> joints =
      options_.rules.empty()
          ? make_joints(motion_.skeleton, roles_, bodies_, limits, start_, options_.joints)
          : joints_of(options_.rules, bodies_, start_);
  std::vector<BodyState> states = start_states();
  leave_out_jumps(states);
  carriers_ = body_of_joint(motion_.skeleton, bodies_);
  follower_.emplace(motion_, bodies_, origin_);
  fall_.follows = follower_->follows();
  follower_->prepare(options_.at, options_.at + options_.duration, roles_, states, joints);
  slides_.assign(bodies_.size(), false);
  for (const Joint& joint : joints) {
    slides_[at(joint.child)] = can_slide(joint);
  }
  if (Status status = world_.add(bodies_, states, joints); !status) return status;
  fall_.settling.penetration = world_.measures().penetration;
  fall_.least_height = std::numeric_limits<double>::infinity();

  Clip& clip = fall_.clip;
  clip.skeleton = motion_.skeleton;
  clip.rate = motion_.rate;
  clip.provenance = motion_.provenance;
  // The frame at `at`, or the next one, is the first of the fall.
  fall_.first_frame = static_cast<int>(std::ceil(options_.at * motion_.rate - 1e-6));
  const double end = (options_.at + options_.duration) * motion_.rate;
  frames_ = std::max(fall_.first_frame + 1, static_cast<int>(std::floor(end + 1e-6)) + 1);
  clip.resize(frames_);
  for (int f = 0; f < fall_.first_frame; ++f) {
    std::ranges::copy(motion_.frame_positions(f), clip.frame_positions(f).begin());
    std::ranges::copy(motion_.frame_orientations(f), clip.frame_orientations(f).begin());
  }
  next_frame_ = fall_.first_frame;
  return {};
}

void FallMaker::apply_pushes(int step) {
  for (const Push& push : options_.pushes) {
    const double late = std::max(0.0, push.time - options_.at);
    if (static_cast<int>(std::lround(late / World::kStep)) == step) {
      world_.push(push.body, push.impulse);
    }
  }
}

Pose FallMaker::pose() const {
  Pose pose(start_.size()), playing(start_.size());
  if (fall_.follows) world_to_local(motion_.skeleton.parents, follower_->pose(), playing);
  std::vector<int> own(start_.size(), -1);
  for (std::size_t b = 0; b < bodies_.size(); ++b) own[at(bodies_[b].joint)] = static_cast<int>(b);
  for (std::size_t j = 0; j < pose.size(); ++j) {
    const int parent = motion_.skeleton.parents[j];
    const bool plays = follower_->plays_on(parent < 0 ? 0 : std::max(0, carriers_[at(parent)]));
    const Transform& local = plays ? playing[j] : locals_[j];
    pose[j] = parent < 0 ? local : pose[at(parent)] * local;
    if (own[j] < 0) continue;
    const Transform to_world =
        world_.state(own[j]).to_world * bodies_[at(own[j])].to_joint.inverse();
    pose[j].orientation = to_world.orientation.normalized();
    if (own[j] == 0 || slides_[at(own[j])]) pose[j].position = to_world.position + origin_;
  }
  return pose;
}

// Animated bodies keep the motion, bit for bit.
void FallMaker::copy_animated() {
  if (!fall_.follows) return;
  const int frame = std::min(next_frame_, motion_.frame_count() - 1);
  for (std::size_t j = 0; j < carriers_.size(); ++j) {
    if (bodies_[at(std::max(0, carriers_[j]))].mode != BodyMode::animated) continue;
    fall_.clip.frame_positions(next_frame_)[j] = motion_.frame_positions(frame)[j];
    fall_.clip.frame_orientations(next_frame_)[j] = motion_.frame_orientations(frame)[j];
  }
}

// The frames in [from, to), seconds of the motion.
void FallMaker::add_frames(double from, double to, const Pose& before, const Pose& after) {
  Pose local_a(before.size()), local_b(before.size()), between(before.size());
  for (; next_frame_ < frames_; ++next_frame_) {
    const double time = std::max(options_.at, next_frame_ / motion_.rate);
    if (time >= to - 1e-9) return;
    const double share = std::clamp((time - from) / (to - from), 0.0, 1.0);
    world_to_local(motion_.skeleton.parents, before, local_a);
    world_to_local(motion_.skeleton.parents, after, local_b);
    for (std::size_t j = 0; j < between.size(); ++j) {
      between[j].position =
          local_a[j].position + share * (local_b[j].position - local_a[j].position);
      between[j].orientation = slerp(local_a[j].orientation, local_b[j].orientation, share);
    }
    local_to_world(motion_.skeleton.parents, between, between);
    fall_.clip.set_pose(next_frame_, between);
    copy_animated();
  }
}

// The mean is of squares until run() ends.
void FallMaker::measure_off() {
  if (!fall_.follows) return;
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    const Quat target =
        follower_->pose()[at(bodies_[b].joint)].orientation * bodies_[b].to_joint.orientation;
    const double off =
        angle_between(world_.state(static_cast<int>(b)).to_world.orientation, target);
    fall_.mean_off += off * off / static_cast<double>(bodies_.size());
    fall_.largest_off = std::max(fall_.largest_off, off);
  }
}

// False once the character rests.
bool FallMaker::step(int number) {
  follower_->lead(world_, options_.at + (number + 1) * World::kStep, options_.world.gravity);
  world_.step();
  measure_off();
  const WorldMeasures now = world_.measures();
  WorldMeasures& largest = number * World::kStep < kSettling ? fall_.settling : fall_.largest;
  largest.joint_gap = std::max(largest.joint_gap, now.joint_gap);
  largest.limit_excess = std::max(largest.limit_excess, now.limit_excess);
  largest.penetration = std::max(largest.penetration, now.penetration);
  largest.contacts = std::max(largest.contacts, now.contacts);
  bool still = now.contacts > 0 && !still_.empty();
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    const BodyState state = world_.state(static_cast<int>(b));
    still = still && (state.to_world.position - still_[b].position).norm() < kStill &&
            angle_between(state.to_world.orientation, still_[b].orientation) < kTurn;
    fall_.least_height = std::min(fall_.least_height, state.to_world.position.y());
  }
  const double time = (number + 1) * World::kStep;
  fall_.simulated = time;
  if (!still) {
    still_.clear();
    for (std::size_t b = 0; b < bodies_.size(); ++b) {
      still_.push_back(world_.state(static_cast<int>(b)).to_world);
    }
    still_since_ = time;
    return true;
  }
  if (fall_.follows || time - still_since_ < kRest) return true;
  for (const Push& push : options_.pushes) {
    if (push.time - options_.at >= time) return true;
  }
  fall_.rest = still_since_;
  return false;
}

bool FallMaker::is_in_bounds() const {
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    const BodyState state = world_.state(static_cast<int>(b));
    // Comparisons with what is not a number are false.
    if (!(state.to_world.position.norm() <= kFarthest) ||
        !state.to_world.orientation.coeffs().allFinite()) {
      return false;
    }
  }
  return true;
}

Status FallMaker::run() {
  const double end = (frames_ - 1) / motion_.rate;
  double time = options_.at;
  for (int number = 0; time < end + World::kStep; ++number) {
    const double next = options_.at + (number + 1) * World::kStep;
    // Steps are shorter than frames: most have none within them.
    const bool has_frame = next_frame_ < frames_ && next_frame_ / motion_.rate < next - 1e-9;
    const Pose before = has_frame ? pose() : Pose();
    apply_pushes(number);
    const bool moves = step(number);
    if (!is_in_bounds()) {
      return Error("ragdoll-value",
                   "the simulation left its bounds, 10 km around the begin of the fall",
                   "a shorter --duration if it falls off the ground; weaker pushes, shapes that do "
                   "not overlap, or a begin where the motion does "
                   "not jump (after a rest frame)");
    }
    if (has_frame) add_frames(time, next, before, pose());
    time = next;
    if (!moves) break;
  }
  const Pose last = pose();
  for (; next_frame_ < frames_; ++next_frame_) fall_.clip.set_pose(next_frame_, last);
  fall_.mean_off = std::sqrt(fall_.mean_off * World::kStep / fall_.simulated);
  if (!options_.go_on) return {};
  auto whole = go_on(fall_.clip, motion_, kBlend);
  if (!whole) return whole.error();
  fall_.clip = std::move(*whole);
  return {};
}

Status check(const Clip& motion, const std::vector<Body>& bodies, const FallOptions& options) {
  if (motion.frame_count() == 0 || bodies.empty()) {
    return Error("ragdoll-time", "there is no pose to fall from: the motion has no frames");
  }
  if (!(options.at >= 0) || !(options.at <= motion.duration() + 1e-9)) {
    return Error("ragdoll-time", "the fall begins outside the motion");
  }
  if (!(options.duration >= 0) || !(options.duration <= kLongest)) {
    return Error("ragdoll-time", "the fall's duration is not from 0 to 600 s");
  }
  for (const Push& push : options.pushes) {
    if (push.body < 0 || at(push.body) >= bodies.size() || !push.impulse.allFinite() ||
        !std::isfinite(push.time)) {
      return Error("ragdoll-value", "a push is at no body, or not finite");
    }
  }
  return {};
}

}  // namespace

std::vector<Transform> pose_at(const Clip& clip, double time) {
  Pose pose(clip.skeleton.names.size()), scratch(3 * pose.size());
  sample(clip, time, pose, scratch);
  return pose;
}

Result<Fall> simulate_fall(const Clip& motion, const RoleMap& roles,
                           const std::vector<Body>& bodies, const ik::Limits& limits,
                           const FallOptions& options) {
  if (Status status = check(motion, bodies, options); !status) return status.error();
  FallMaker maker(motion, roles, bodies, options);
  if (Status status = maker.begin(limits); !status) return status.error();
  if (Status status = maker.run(); !status) return status.error();
  return maker.take();
}

}  // namespace krok::ragdoll
