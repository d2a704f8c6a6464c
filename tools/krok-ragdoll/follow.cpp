#include "tools/krok-ragdoll/follow.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "core/index.h"
#include "core/numbers.h"
#include "core/text.h"
#include "formats/goals/goals.h"
#include "tools/cli/option_kinds.h"

namespace krok::cli::ragdoll {

namespace {

using krok::ragdoll::Body;
using krok::ragdoll::BodyMode;

constexpr double kFall = 3;       // seconds
constexpr double kHold = 0.5;     // of powered characters
constexpr double kPushSpeed = 1;  // m/s that a push gives the whole body
constexpr double kAside = 60 * kRadiansPerDegree;

// The mean of [0, 1), the same on every machine.
double chance(std::mt19937& random) {
  return random() / 4294967296.0;
}

bool follows_motion(const std::vector<Body>& bodies) {
  return std::ranges::any_of(bodies,
                             [](const Body& body) { return body.mode != BodyMode::simulated; });
}

// To the character's left, horizontal.
Vec3 left_of(const Clip& motion, const RoleMap& roles, double time) {
  const int left = roles.joint(Role::left_upper_leg), right = roles.joint(Role::right_upper_leg);
  if (left < 0 || right < 0) return Vec3::UnitX();
  const auto pose = krok::ragdoll::pose_at(motion, time);
  Vec3 across = pose[at(left)].position - pose[at(right)].position;
  across.y() = 0;
  return across.norm() > 1e-6 ? Vec3(across.normalized()) : Vec3(Vec3::UnitX());
}

}  // namespace

void declare_follow(CommandOptions& command, FollowOptions& o) {
  const ValueKind<double> strength = number({0, 1});
  command.group("Playing on");
  command.add("--powered STRENGTH", o.powered, strength,
              "Motors in the joints follow the motion: 1 as strong as an adult, 0 limp");
  command
      .add("--hold STRENGTH", o.hold, strength,
           "Hold the root body to the motion from outside, as if by hand: 0 free, 1 as animated; "
           "0.5 with --powered, which keeps walkers on their feet",
           "0")
      .not_with("--simulated");
  command
      .add_option("--simulated JOINT", o.simulated,
                  "Simulate only the bodies from this joint on, given by name or role, limp or as "
                  "strong as --powered; all others stay animated; repeatable")
      .one_each_time();
  command.add("--push-every", o.push_every, seconds({0.1, 600}),
              "Push the chest at this spacing, to alternate sides, with what gives the body 1 m/s");
  command
      .add("--seed", o.seed, whole(0, std::numeric_limits<std::uint32_t>::max()),
           "Seed of the directions of --push-every", "1")
      .only_with("--push-every");
  command.add("--until", o.until, clip_time(kPositive),
              "Time from which the motion goes on alone, blended within 0.5 s");
}

namespace {

Status choose_modes(const FollowOptions& options, const Skeleton& skeleton, const RoleMap& roles,
                    std::vector<Body>& bodies) {
  if (!options.any()) return {};
  const double strength = options.powered.value_or(0);
  const BodyMode of_rest = strength > 0 ? BodyMode::powered : BodyMode::simulated;
  std::vector<bool> chosen(bodies.size(), options.simulated.empty());
  for (const std::string& name : options.simulated) {
    const int joint = find_joint(skeleton, roles, name);
    if (joint < 0) {
      return Error(
          "ragdoll-joint",
          fmt::format("--simulated {}: the motion has no joint of that name or role", shown(name)),
          nearest_hint(name, skeleton.names));
    }
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      for (int j = bodies[b].joint; j >= 0; j = skeleton.parents[at(j)]) {
        if (j == joint) chosen[b] = true;
      }
    }
    if (std::ranges::find(chosen, true) == chosen.end()) {
      return Error(
          "ragdoll-joint",
          fmt::format("--simulated {}: no body moves with it or a joint below it", shown(name)),
          "--save-bodies shows what joints have bodies");
    }
  }
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    bodies[b].mode = chosen[b] ? of_rest : BodyMode::animated;
    bodies[b].strength = strength;
  }
  if (options.simulated.empty()) {
    Body& root = bodies.front();
    root.strength = options.hold.value_or(options.powered ? kHold : 0.0);
    root.mode = root.strength >= 1  ? BodyMode::animated
                : root.strength > 0 ? BodyMode::powered
                                    : BodyMode::simulated;
  }
  return {};
}

// The pushes from `begin` to before `end`, seconds of the motion.
std::vector<krok::ragdoll::Push> regular_pushes(const FollowOptions& options, const Clip& motion,
                                                const RoleMap& roles,
                                                const std::vector<Body>& bodies, double begin,
                                                double end) {
  std::vector<krok::ragdoll::Push> pushes;
  if (options.push_every <= 0) return pushes;
  const auto carriers = krok::ragdoll::body_of_joint(motion.skeleton, bodies);
  const int chest = roles.joint(Role::chest), head = roles.joint(Role::head);
  int body = chest >= 0 ? carriers[at(chest)] : head >= 0 ? carriers[at(head)] : 0;
  if (chest < 0 && body > 0) body = bodies[at(body)].parent;
  double mass = 0;
  for (const Body& each : bodies) mass += each.mass;
  std::mt19937 random(options.seed);
  for (int i = 1; begin + i * options.push_every < end; ++i) {
    const double time = begin + i * options.push_every;
    const double aside = kAside * (2 * chance(random) - 1);
    const Vec3 left = left_of(motion, roles, time), forward = left.cross(Vec3::UnitY());
    const double side = i % 2 == 1 ? 1 : -1;
    const Vec3 way = side * (std::cos(aside) * left + std::sin(aside) * forward);
    pushes.push_back({std::max(0, body), kPushSpeed * mass * way, time});
  }
  return pushes;
}

}  // namespace

Status set_modes(const FollowOptions& options, bool gets_up, const Skeleton& skeleton,
                 const RoleMap& roles, std::vector<Body>& bodies) {
  if (Status status = choose_modes(options, skeleton, roles, bodies); !status) return status;
  const bool follows = follows_motion(bodies);
  if (!follows && options.until) {
    return usage("--until: nothing follows the motion that is to go on",
                 "give --powered, --hold or --simulated, or bodies with modes");
  }
  if (follows && gets_up) {
    return usage("--get-up needs a fall that comes to rest; the bodies follow the motion");
  }
  return {};
}

Status set_end(const FollowOptions& options, std::optional<double> duration, const Clip& motion,
               const RoleMap& roles, const std::vector<Body>& bodies,
               krok::ragdoll::FallOptions& fall) {
  const double rest = std::max(0.0, motion.duration() - fall.at);
  fall.duration = duration.value_or(follows_motion(bodies) ? rest : kFall);
  if (options.until) {
    const double until = options.until->seconds(motion.rate);
    if (until <= fall.at || until > motion.duration() + 1e-9) {
      return Error("ragdoll-time",
                   fmt::format("--until {} s is not between the begin, {} s, and the motion's end, "
                               "{} s",
                               readable(until), readable(fall.at), readable(motion.duration())));
    }
    fall.duration = until - fall.at;
    fall.go_on = true;
  }
  const auto pushes =
      regular_pushes(options, motion, roles, bodies, fall.at, fall.at + fall.duration);
  fall.pushes.insert(fall.pushes.end(), pushes.begin(), pushes.end());
  return {};
}

}  // namespace krok::cli::ragdoll
