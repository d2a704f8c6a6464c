// Falls of a walker who is pushed at random moments, and what they cost. Prints how exact they are,
// how many times real time they run while the body moves, beside a btMultiBody of the same bodies
// in Bullet's own world, and a hash of the results.
//
//   build/bench/ragdoll [FALLS [GROUND]]   20 without a number; KROK_BENCH_EACH=1 prints each fall
//
// GROUND is up or down (stairs), slope or rough; without it, the ground is level.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <random>
#include <string>

#include "core/hash.h"
#include "core/index.h"
#include "ik/anatomical_limits.h"
#include "math/quaternion.h"
#include "motion/sample.h"
#include "motion/travel.h"
#include "ragdoll/get_up.h"
#include "ragdoll/multibody.h"
#include "ragdoll/simulate.h"
#include "samples/generator/walk.h"
#include "terrain/spec.h"
#include "terrain/surface.h"

namespace {

using namespace krok;
using namespace krok::ragdoll;

// Of this process, so that others on the machine do not count.
double seconds() {
  return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

struct Walker {
  Clip clip;
  RoleMap roles;
  std::vector<Body> bodies;
  ik::Limits limits;
};

// Straight, in a curve, with short and with long steps, and from standing.
std::vector<Walker> make_walkers(double rise) {
  std::vector<Walker> walkers;
  for (int kind = 0; kind < 5; ++kind) {
    samples::WalkOptions options;
    options.steps = 6;
    options.rate = 60;
    if (kind == 1) options.turn = 20 * kRadiansPerDegree;
    if (kind == 2) options.step_length = 0.5;
    if (kind == 3) options.step_length = 0.85;
    if (kind == 4) options.from_standing = true;
    if (rise != 0) {
      options.rise = rise;
      options.step_length = 0.3;
      options.turn = 0;
    }
    Walker walker;
    walker.clip = samples::make_walk(options)->clip;
    walker.roles = find_roles(walker.clip.skeleton);
    walker.bodies = *make_bodies(walker.clip.skeleton, walker.roles);
    walker.limits = ik::anatomical_limits(walker.clip.skeleton, walker.roles);
    walkers.push_back(std::move(walker));
  }
  return walkers;
}

double share(std::mt19937& random) {
  return random() / 4294967296.0;
}

// Rest is to begin within 5 s; that it is rest is seen half a second later.
constexpr double kSoon = 5, kSeen = 5.6;  // seconds

// What the walkers fall on.
struct Ground {
  const char* name;
  const char* spec;
  double rise;  // of a step, metres
};

constexpr Ground kGrounds[] = {
    {"level", "level", 0},
    {"up", "stairs:rise=17cm,run=30cm,count=12,begin=0.25m", 0.17},
    {"down", "stairs:rise=-17cm,run=30cm,count=12,begin=0.2m", -0.17},
    {"slope", "slope:20deg,begin=-1m", 0},
    {"rough", "rough:seed=3,height=25cm", 0},
};

struct Place {
  std::unique_ptr<Terrain> terrain;
  Surroundings surroundings;
};

Place make_place(const Ground& ground) {
  Place place;
  place.terrain = *terrain::from_spec(ground.spec);
  place.surroundings.level = std::string(ground.spec) == "level";
  if (place.surroundings.level) return place;
  const auto surface =
      terrain::surface_of(*place.terrain, {Vec2(-10, -10), Vec2(10, 14), 0.001, 200'000});
  for (const auto& corners : surface->triangles) {
    auto& triangle = place.surroundings.triangles.emplace_back();
    for (std::size_t k = 0; k < 3; ++k) {
      triangle[k] = surface->positions[corners[k]].cast<double>();
    }
  }
  return place;
}

GroundHeight heights_of(const Place& place) {
  return [&place](double x, double z) {
    const auto point = place.terrain->at(x, z);
    return point ? std::optional<double>(point->height) : std::nullopt;
  };
}

// Metres that bodies are below the terrain itself, straight up, 0.2 s after the begin and later: a
// check of what the simulation reports, which knows only the contacts that it finds. On stairs it
// is too large beside a riser.
double depth_below(const Place& place, const Walker& walker, const Fall& fall) {
  double deepest = 0;
  std::vector<Transform> pose(fall.clip.skeleton.names.size());
  const int begin = fall.first_frame + static_cast<int>(std::ceil(0.2 * fall.clip.rate));
  for (int f = begin; f < fall.clip.frame_count(); ++f) {
    fall.clip.get_pose(f, pose);
    deepest = std::max(deepest, depth_in_ground(walker.bodies, pose, heights_of(place)));
  }
  return deepest;
}

// Up or down to where the walker stands on the ground when the fall begins.
Clip on_ground(const Walker& walker, double when, const Place& place) {
  Clip clip = walker.clip;
  if (place.surroundings.level) return clip;
  Transform move;
  move.position.y() = depth_in_ground(walker.bodies, pose_at(clip, when), heights_of(place));
  move_clip(move, clip);
  return clip;
}

FallOptions random_fall(const Walker& walker, const Place& place, std::mt19937& random) {
  FallOptions options;
  options.at = walker.clip.duration() * share(random);
  options.duration = kSeen;
  options.surroundings = place.surroundings;
  Push push;
  push.body = static_cast<int>(share(random) * static_cast<double>(walker.bodies.size()));
  const double angle = 2 * kPi * share(random);
  push.impulse = walker.bodies[at(push.body)].mass * (1 + 7 * share(random)) *
                 Vec3(std::cos(angle), 0.2, std::sin(angle));
  push.time = options.at;
  options.pushes = {push};
  return options;
}

void run_falls(const std::vector<Walker>& walkers, const Place& place, int count) {
  std::mt19937 random(7);
  WorldMeasures worst, settling;
  int at_rest = 0, bad = 0, deep = 0;
  double time = 0, moving = 0, whole = 0, latest = 0, highest = 0, below = 0;
  Xxh3Stream hash;
  for (int i = 0; i < count; ++i) {
    const Walker& walker = walkers[at(i) % walkers.size()];
    const FallOptions options = random_fall(walker, place, random);
    const Clip clip = on_ground(walker, options.at, place);
    const double begin = seconds();
    const auto fall = simulate_fall(clip, walker.roles, walker.bodies, walker.limits, options);
    time += seconds() - begin;
    if (!fall.ok() || !check(fall->clip).ok()) {
      ++bad;
      continue;
    }
    at_rest += fall->rest >= 0 && fall->rest <= kSoon ? 1 : 0;
    deep += fall->largest.penetration > 0.005 ? 1 : 0;
    latest = std::max(latest, fall->rest);
    moving += fall->simulated;
    whole += options.duration;
    const auto add = [](WorldMeasures& sum, const WorldMeasures& of) {
      sum.joint_gap = std::max(sum.joint_gap, of.joint_gap);
      sum.limit_excess = std::max(sum.limit_excess, of.limit_excess);
      sum.penetration = std::max(sum.penetration, of.penetration);
    };
    if (std::getenv("KROK_BENCH_EACH") != nullptr) {
      std::printf("%d: rest %.2f, gap %.4f mm, limits %.2f deg, penetration %.2f mm\n", i,
                  fall->rest, fall->largest.joint_gap * 1e3,
                  fall->largest.limit_excess / kRadiansPerDegree, fall->largest.penetration * 1e3);
    }
    if (place.terrain != nullptr) below = std::max(below, depth_below(place, walker, *fall));
    add(worst, fall->largest);
    add(settling, fall->settling);
    double top = 0;
    for (const Vec3f& joint : fall->clip.frame_positions(fall->clip.frame_count() - 1)) {
      top = std::max(top, static_cast<double>(joint.y()));
    }
    highest = std::max(highest, top);
    hash.update(std::as_bytes(std::span(fall->clip.positions)));
    hash.update(std::as_bytes(std::span(fall->clip.orientations)));
  }
  std::printf(
      "%d falls, %zu bodies: %d not finite, %d (%.1f %%) at rest within 5 s, the latest after %.2f "
      "s\n",
      count, walkers[0].bodies.size(), bad, at_rest, 100.0 * at_rest / count, latest);
  const auto print = [](const char* what, const WorldMeasures& of) {
    std::printf(
        "  %s: joints apart by %.2g mm, limits exceeded by %.2f degrees, ground by %.2f mm\n", what,
        of.joint_gap * 1e3, of.limit_excess / kRadiansPerDegree, of.penetration * 1e3);
  };
  print("first 0.2 s", settling);
  print("after that ", worst);
  std::printf("  %d falls more than 5 mm in the ground\n", deep);
  std::printf("  below the terrain itself by %.2f mm\n", below * 1e3);
  std::printf("  highest joint at the end %.2f m\n", highest);
  std::printf("  %.1f x real time while moving (%.1f us a step), %.1f x of the falls' length\n",
              moving / time, time / moving * World::kStep * 1e6, whole / time);
  std::printf("  hash %s\n", hex(hash.digest()).c_str());
}

// Walks that powered bodies of an adult's strength follow to their end, the root animated, and held
// while someone pushes.
void run_powered(const std::vector<Walker>& walkers) {
  const auto run = [&](double strength, double hold, double push) {
    double mean = 0, largest = 0, depth = 0, time = 0, simulated = 0;
    for (const Walker& walker : walkers) {
      auto bodies = walker.bodies;
      for (Body& body : bodies) {
        body.mode = BodyMode::powered;
        body.strength = strength;
      }
      bodies[0].mode = hold < 1 ? BodyMode::powered : BodyMode::animated;
      bodies[0].strength = hold;
      FallOptions options;
      options.duration = walker.clip.duration();
      options.surroundings.level = true;
      if (push > 0) options.pushes = {{2, Vec3(push, 0, 0), 1}};
      const double begin = seconds();
      const auto fall = simulate_fall(walker.clip, walker.roles, bodies, walker.limits, options);
      time += seconds() - begin;
      if (!fall) continue;
      mean += fall->mean_off * fall->mean_off / static_cast<double>(walkers.size());
      largest = std::max(largest, fall->largest_off);
      depth = std::max(depth, fall->largest.penetration);
      simulated += fall->simulated;
    }
    std::printf(
        "powered %.1f, root held %.1f, push %.0f Ns: %.2f degrees RMS off the walks, at most %.1f, "
        "ground by %.2f mm, %.1f x real time\n",
        strength, hold, push, std::sqrt(mean) / kRadiansPerDegree, largest / kRadiansPerDegree,
        depth * 1e3, simulated / time);
  };
  run(1, 1, 0);
  run(1, 0.5, 0);
  run(0.6, 0.5, 0);
  run(0.6, 0.5, 75);
}

// The same start in Bullet's own world. It does not bring the bodies to rest, so all of it counts.
void run_bullet(const Walker& walker, int count) {
  std::mt19937 random(7);
  double time = 0, deepest = 0;
  int steps = 0, moving = 0;
  for (int i = 0; i < count; ++i) {
    const double margin = 1.5 / walker.clip.rate;
    const double begin = margin + (walker.clip.duration() - 2 * margin) * share(random);
    const auto pose_at = [&](double moment) {
      std::vector<Transform> pose(walker.clip.skeleton.names.size()), scratch(3 * pose.size());
      sample(walker.clip, moment, pose, scratch);
      return pose;
    };
    const auto pose = pose_at(begin), before = pose_at(begin - 1 / walker.clip.rate),
               after = pose_at(begin + 1 / walker.clip.rate);
    const double angle = 2 * kPi * share(random), strength = 1 + 2 * share(random);
    std::vector<BodyState> states;
    for (const Body& body : walker.bodies) {
      const std::size_t j = at(body.joint);
      const Transform a = before[j] * body.to_joint, b = after[j] * body.to_joint;
      const double rate = 0.5 * walker.clip.rate;
      states.push_back({pose[j] * body.to_joint, rate * (b.position - a.position),
                        rate * rotation_vector(b.orientation * a.orientation.conjugate())});
    }
    states[0].velocity += strength * Vec3(std::cos(angle), 0.2, std::sin(angle));
    const auto joints =
        make_joints(walker.clip.skeleton, walker.roles, walker.bodies, walker.limits, pose, {});
    Multibody world(walker.bodies, states, joints, 10);
    const double start = seconds();
    for (int step = 0; step < 1200; ++step, ++steps) {
      world.step();
      if (step > 48) deepest = std::max(deepest, world.penetration());
    }
    time += seconds() - start;
    moving += world.fastest() > 0.3 ? 1 : 0;
  }
  std::printf(
      "btMultiBody alone, %d falls: %.1f x real time (%.1f us a step), ground by %.1f mm, "
      "%d not at rest after 5 s\n",
      count, steps * World::kStep / time, time / steps * 1e6, deepest * 1e3, moving);
}

}  // namespace

int main(int argc, char** argv) {
  const int falls = argc > 1 ? std::max(1, std::atoi(argv[1])) : 20;
  const std::string name = argc > 2 ? argv[2] : "level";
  for (const Ground& ground : kGrounds) {
    if (ground.name != name) continue;
    const std::vector<Walker> walkers = make_walkers(ground.rise);
    run_falls(walkers, make_place(ground), falls);
    if (ground.name == std::string("level")) {
      run_powered(walkers);
      run_bullet(walkers[0], std::min(falls, 10));
    }
    return 0;
  }
  std::fprintf(stderr, "no ground '%s'\n", name.c_str());
  return 2;
}
