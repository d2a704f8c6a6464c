// Robot arms after the protocol of TRAC-IK (Beeson and Ames 2015): random joint angles within the
// limits give a reachable pose; solvers start from the middle of all ranges, must come within 1e-5
// (metres and radians) and have 5 ms. Beside Orocos KDL's solver on the same poses in the same run,
// where it is installed. Prints rates, times of this machine and a hash of the results.

#include <algorithm>
#include <cstdio>
#include <random>
#include <string>
#include <vector>

#include "bench/ik/arms.h"
#include "bench/ik/parts.h"
#include "core/hash.h"
#include "math/quaternion.h"

#ifdef KROK_HAS_KDL
#include <kdl/chain.hpp>
#include <kdl/chainfksolverpos_recursive.hpp>
#include <kdl/chainiksolverpos_nr_jl.hpp>
#include <kdl/chainiksolvervel_pinv.hpp>
#endif

namespace krok::bench {
namespace {

constexpr int kPoses = 10'000;
constexpr double kTolerance = 1e-5;
constexpr double kLongest = 5e-3;  // seconds

struct Scores {
  int solved = 0;
  double seconds = 0, slowest = 0;
  long iterations = 0, starts = 0;
  void take(bool good, double time) {
    solved += good && time <= kLongest ? 1 : 0;
    seconds += time;
    slowest = std::max(slowest, time);
  }
  void print(const char* name) const {
    std::printf("  %-22s %6.2f %% solved, mean %.4f ms, slowest %.2f ms", name,
                100.0 * solved / kPoses, 1e3 * seconds / kPoses, 1e3 * slowest);
    if (iterations > 0) {
      std::printf(", %.1f iterations from %.2f starts", double(iterations) / kPoses,
                  double(starts) / kPoses);
    }
    std::printf("\n");
  }
};

std::vector<std::vector<double>> random_angles(const Arm& arm) {
  std::mt19937_64 random(20);
  std::vector<std::vector<double>> all;
  for (int i = 0; i < kPoses; ++i) {
    std::vector<double> angles;
    for (const Link& link : arm.links) {
      // Not std::uniform_real_distribution, whose numbers are the library's own.
      const double unit = static_cast<double>(random() >> 11) * 0x1p-53;
      angles.push_back((link.lowest + unit * (link.highest - link.lowest)) * kRadiansPerDegree);
    }
    all.push_back(angles);
  }
  return all;
}

void run_krok(const Arm& arm, const Solving& solving,
              const std::vector<std::vector<double>>& poses) {
  const ArmJoints joints = joints_of(arm);
  ik::Options options;
  options.method = solving.method;
  options.distance = options.angle = kTolerance;
  options.iterations = solving.iterations;
  options.restarts = 150;
  auto solver = ik::Solver::create(joints.parents, joints.limits, options);
  Scores scores;
  double worst_excess = 0;
  std::vector<Transform> results;
  for (const auto& angles : poses) {
    const Transform wanted = end_of(arm, angles);
    ik::Goal goal;
    goal.kind = ik::Goal::Kind::pose;
    goal.joint = static_cast<int>(joints.parents.size()) - 1;
    goal.point = joints.tip.position;
    goal.target = wanted.position;
    goal.orientation = wanted.orientation * joints.tip.orientation.conjugate();
    std::vector<Transform> pose = joints.middle;
    const double begin = seconds();
    const auto outcome = solver->solve({&goal, 1}, pose);
    const double time = seconds() - begin;
    // Judged from the joints' angles by the arm's own parameters, not by what the solver says.
    std::vector<double> found;
    for (std::size_t j = 0; j < pose.size(); ++j) {
      const Quat local =
          j == 0 ? pose[0].orientation : pose[j - 1].orientation.conjugate() * pose[j].orientation;
      found.push_back(measure(joints.limits[j], local).twist);
      worst_excess = std::max(worst_excess, excess(joints.limits[j], local));
    }
    const Transform end = end_of(arm, found);
    const bool good = (end.position - wanted.position).norm() <= kTolerance &&
                      angle_between(end.orientation, wanted.orientation) <= kTolerance;
    scores.take(good, time);
    scores.iterations += (*outcome)->iterations;
    scores.starts += (*outcome)->starts;
    results.push_back(end);
  }
  scores.print(solving.name);
  std::printf("  limits exceeded by %.1e rad at most; hash of the results %s\n", worst_excess,
              hex(xxh3(std::as_bytes(std::span(results)))).c_str());
}

#ifdef KROK_HAS_KDL
void run_kdl(const Arm& arm, const std::vector<std::vector<double>>& poses) {
  KDL::Chain chain;
  const auto count = static_cast<unsigned>(arm.links.size());
  KDL::JntArray lowest(count), highest(count), middle(count);
  for (unsigned i = 0; i < count; ++i) {
    const Link& link = arm.links[i];
    chain.addSegment(
        KDL::Segment(KDL::Joint(KDL::Joint::RotZ), KDL::Frame::DH(link.a, link.alpha, link.d, 0)));
    lowest(i) = link.lowest * kRadiansPerDegree;
    highest(i) = link.highest * kRadiansPerDegree;
    middle(i) = 0.5 * (lowest(i) + highest(i));
  }
  KDL::ChainFkSolverPos_recursive forward(chain);
  KDL::ChainIkSolverVel_pinv velocity(chain);
  // One iteration a call, so that the time limit can be looked at between, as the protocol does.
  KDL::ChainIkSolverPos_NR_JL solver(chain, lowest, highest, forward, velocity, 1, kTolerance);
  Scores scores;
  for (const auto& angles : poses) {
    KDL::JntArray truth(count), found(count), from = middle;
    for (unsigned i = 0; i < count; ++i) truth(i) = angles[i];
    KDL::Frame wanted, end;
    forward.JntToCart(truth, wanted);
    const double begin = seconds();
    int code = -1;
    while (code < 0 && seconds() - begin < kLongest) {
      code = solver.CartToJnt(from, wanted, found);
      from = found;
    }
    const double time = std::min(kLongest, seconds() - begin);
    forward.JntToCart(found, end);
    scores.take(code >= 0 && KDL::Equal(KDL::diff(end, wanted), KDL::Twist::Zero(), kTolerance),
                time);
  }
  scores.print("KDL");
}
#endif

}  // namespace

void arms() {
  for (const Arm& arm : {puma_560(), lbr_iiwa_14()}) {
    std::printf("%s, %d poses\n", arm.name.c_str(), kPoses);
    const auto poses = random_angles(arm);
    for (const Solving& solving : kSolvings) run_krok(arm, solving, poses);
#ifdef KROK_HAS_KDL
    run_kdl(arm, poses);
#else
    std::printf("  KDL: not installed (liborocos-kdl-dev)\n");
#endif
  }
}

}  // namespace krok::bench

// All parts, or the one that is named: arms, singular, limbs, bodies.
int main(int argc, char** argv) {
  const std::string part = argc > 1 ? argv[1] : "";
  if (part.empty() || part == "arms") krok::bench::arms();
  if (part.empty() || part == "singular") krok::bench::near_singular();
  if (part.empty() || part == "limbs") krok::bench::two_bones();
  if (part.empty() || part == "bodies") krok::bench::whole_bodies();
  return 0;
}
