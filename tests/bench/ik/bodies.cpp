// Whole bodies: both hands, both feet and the head of a pose out of a capture are the goals, with
// position and orientation; limits are those that all poses of the capture keep. Cold: from another
// pose of it, any two. Warm: frame after frame, from the solution before. Real captures of 50 to 75
// joints where the corpus is there, otherwise a body of 60 joints that swings all of them.

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <random>
#include <string>
#include <vector>

#include "bench/ik/parts.h"
#include "core/hash.h"
#include "core/index.h"
#include "formats/io/open_motion.h"
#include "ik/anatomical_limits.h"
#include "ik/limits.h"
#include "ik/solver.h"
#include "roles/roles.h"
#include "support/test_scenes.h"
#include "support/this_build.h"

namespace krok::bench {
namespace {

constexpr int kPoses = 10'000;
constexpr double kDistance = 1e-3;
constexpr double kAngle = 0.1 * kRadiansPerDegree;

struct Body {
  std::string name;
  Clip clip;
  ik::Limits limits;
  std::vector<int> effectors;
  int turning = 0;  // joints, end sites apart
};

std::vector<int> effectors_of(const Skeleton& skeleton) {
  const RoleMap roles = find_roles(skeleton);
  std::vector<int> found;
  for (const Role role :
       {Role::left_hand, Role::right_hand, Role::left_foot, Role::right_foot, Role::head}) {
    if (roles.joint(role) >= 0) found.push_back(roles.joint(role));
  }
  return found;
}

// Adds a body if it has what is asked for.
void add_body(std::string name, Clip clip, std::vector<Body>& bodies) {
  Body body;
  body.turning = static_cast<int>(
      std::count(clip.skeleton.end_sites.begin(), clip.skeleton.end_sites.end(), 0));
  body.effectors = effectors_of(clip.skeleton);
  if (body.turning < 50 || body.turning > 75 || body.effectors.size() != 5 ||
      clip.frame_count() < 40) {
    return;
  }
  body.clip = std::move(clip);
  const Clip* one = &body.clip;
  auto limits = ik::learn_limits(body.clip.skeleton, {&one, 1});
  if (!limits) return;
  body.limits = std::move(*limits);
  body.name = std::move(name);
  bodies.push_back(std::move(body));
}

std::vector<Body> all_bodies() {
  std::vector<Body> bodies;
  namespace fs = std::filesystem;
  const fs::path corpus = fs::path(test::corpus_folder()) / "bvh";
  std::vector<fs::path> files;
  for (const char* folder : {"animated_drawings", "ipi_smartbody", "pybvh", "20tab_bvh-python"}) {
    if (!fs::exists(corpus / folder)) continue;
    for (const auto& entry : fs::directory_iterator(corpus / folder)) {
      if (entry.path().extension() == ".bvh") files.push_back(entry.path());
    }
  }
  std::sort(files.begin(), files.end());
  for (const fs::path& file : files) {
    io::PlainInputs inputs;
    auto clip = io::open_motion(file.string(), inputs);
    if (clip) add_body(file.filename().string(), std::move(*clip), bodies);
  }
  if (!bodies.empty()) return bodies;
  Skeleton skeleton = test::turned_human();
  while (skeleton.joint_count() < 60) {
    const int j = skeleton.joint_count();
    Transform place = skeleton.reference[at(j % 3 == 0 ? 10 : j - 1)];
    place.position += Vec3(0.03, 0, 0.01);
    skeleton.add("more" + std::to_string(j), j % 3 == 0 ? 10 : j - 1, place);
  }
  add_body("a body that swings", test::swinging_clip(skeleton, 1000, 60), bodies);
  return bodies;
}

std::vector<ik::Goal> goals_of(const Body& body, const std::vector<Transform>& pose) {
  std::vector<ik::Goal> goals;
  for (const int joint : body.effectors) {
    ik::Goal goal;
    goal.kind = ik::Goal::Kind::pose;
    goal.joint = joint;
    goal.target = pose[at(joint)].position;
    goal.orientation = pose[at(joint)].orientation;
    goals.push_back(goal);
  }
  return goals;
}

struct Scores {
  int poses = 0, solved = 0;
  double seconds = 0, slowest = 0, excess = 0;
  long iterations = 0;
  std::vector<Transform> results;

  void print(const char* name) {
    std::printf(
        "  %-6s %6.2f %% of %d solved, mean %.1f us, slowest %.0f us, %.1f iterations; limits "
        "exceeded by %.1e rad; hash %s\n",
        name, 100.0 * solved / poses, poses, 1e6 * seconds / poses, 1e6 * slowest,
        double(iterations) / poses, excess, hex(xxh3(std::as_bytes(std::span(results)))).c_str());
  }
};

// Solves for one frame from `pose` and judges the result by the pose alone.
void solve_one(const Body& body, ik::Solver& solver, int frame, std::vector<Transform>& pose,
               Scores& scores) {
  std::vector<Transform> wanted(pose.size());
  body.clip.get_pose(frame, wanted);
  const auto goals = goals_of(body, wanted);
  const double begin = seconds();
  const auto outcome = solver.solve(goals, pose);
  const double time = seconds() - begin;
  bool good = true;
  for (const ik::Residual& miss :
       ik::residuals(goals, body.clip.skeleton.parents, pose, solver.options())) {
    good = good && miss.distance <= kDistance && miss.angle <= kAngle;
  }
  for (std::size_t j = 1; j < pose.size(); ++j) {
    const Transform& parent = pose[at(body.clip.skeleton.parents[j])];
    scores.excess =
        std::max(scores.excess,
                 ik::excess(body.limits[j], parent.orientation.conjugate() * pose[j].orientation));
  }
  ++scores.poses;
  scores.solved += good ? 1 : 0;
  scores.seconds += time;
  scores.slowest = std::max(scores.slowest, time);
  scores.iterations += (*outcome)->iterations;
  for (const int joint : body.effectors) scores.results.push_back(pose[at(joint)]);
}

ik::Solver make_solver(const Body& body, int restarts) {
  ik::Options options;
  options.distance = 0.9 * kDistance;
  options.angle = 0.9 * kAngle;
  options.root_moves = true;
  options.restarts = restarts;
  auto solver = ik::Solver::create(body.clip.skeleton.parents, body.limits, options);
  return std::move(*solver);
}

}  // namespace

void whole_bodies() {
  const std::vector<Body> bodies = all_bodies();
  int frames = 0, fewest = 1000, most = 0;
  for (const Body& body : bodies) {
    frames += body.clip.frame_count();
    fewest = std::min(fewest, body.turning);
    most = std::max(most, body.turning);
  }
  std::printf("whole bodies: %zu motions of %d to %d joints (end sites apart), %d frames\n",
              bodies.size(), fewest, most, frames);
  Scores cold, warm;
  std::mt19937_64 random(7);
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const Body& body = bodies[b];
    const auto count = static_cast<std::uint64_t>(body.clip.frame_count());
    std::vector<Transform> pose(body.clip.skeleton.names.size());
    ik::Solver solver = make_solver(body, 20);
    const int share = b + 1 == bodies.size()
                          ? kPoses - cold.poses
                          : static_cast<int>(kPoses * std::int64_t(count) / frames);
    for (int i = 0; i < share; ++i) {
      body.clip.get_pose(static_cast<int>(random() % count), pose);
      solve_one(body, solver, static_cast<int>(random() % count), pose, cold);
    }
    // Back and forth, so that every pass begins where the one before ended.
    ik::Solver next = make_solver(body, 20);
    body.clip.get_pose(0, pose);
    const int frame_count = body.clip.frame_count();
    for (int i = 0; i < share; ++i) {
      const int turn = i % (2 * frame_count - 2);
      solve_one(body, next, turn < frame_count ? turn : 2 * frame_count - 2 - turn, pose, warm);
    }
  }
  cold.print("cold");
  warm.print("warm");
}

}  // namespace krok::bench
