// Steps blended from libraries of 9 and 27 examples of a figure of 29 joints: a full-body frame at
// a moment (the time map, each example at its own time, the weighted sum, set on the stance foot),
// to the parents and to the world, beside a plain version that does the same with Clip's own
// sampling; and what is measured for weights, with and without its derivatives. Rounds take turns
// and the fastest of each counts; what is printed are ratios, which compare across machines, times
// of this one, and a hash of the results.

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <functional>
#include <string>
#include <vector>

#include "core/hash.h"
#include "math/quaternion.h"
#include "motion/sample.h"
#include "parametric/blended_motion.h"
#include "parametric/measure.h"
#include "pose/packed_pose.h"
#include "unit/parametric/walks.h"

namespace {

using namespace krok;
using namespace krok::parametric;

constexpr int kFrames = 64;  // a round

// The same motion without packing: joints one by one, in doubles.
void plain_pose(const Library& library, const PackedExamples& packed,
                std::span<const double> weights, double generic, std::span<Transform> pose,
                std::span<Transform> space) {
  const auto joints = pose.size();
  const auto sum = space.subspan(3 * joints, joints), one = space.subspan(4 * joints, joints);
  for (std::size_t j = 0; j < joints; ++j) {
    sum[j].position.setZero();
    sum[j].orientation.coeffs().setZero();
  }
  const GenericTimePoint place = generic_place(packed.generic, generic);
  for (std::size_t i = 0; i < weights.size(); ++i) {
    const double time = example_time(packed, place, static_cast<int>(i));
    sample(library.examples[i].motion, time, pose, space.first(3 * joints));
    world_to_local(library.skeleton.parents, pose, one);
    for (std::size_t j = 0; j < joints; ++j) {
      sum[j].position += weights[i] * one[j].position;
      const double sign = sum[j].orientation.dot(one[j].orientation) < 0 ? -1 : 1;
      sum[j].orientation.coeffs() += sign * weights[i] * one[j].orientation.coeffs();
    }
  }
  for (Transform& joint : sum) joint.orientation = normalized_or_identity(joint.orientation);
  local_to_world(library.skeleton.parents, sum, pose);
}

struct Part {
  std::string name;
  double items;
  std::function<void()> run;
  double best = 1e9;
  double microseconds() const { return best / items * 1e6; }
};

void measure_parts(std::vector<Part>& parts) {
  using Clock = std::chrono::steady_clock;
  for (int round = 0; round < 200; ++round) {
    for (Part& part : parts) {
      const auto begin = Clock::now();
      part.run();
      part.best = std::min(part.best, std::chrono::duration<double>(Clock::now() - begin).count());
    }
  }
}

void run(bool turns) {
  const Library library = parametric::test::library_of(parametric::test::grid_walks(turns),
                                                       {"step.length", "step.height", "step.turn"},
                                                       {.mirror = false, .outlier = 0})
                              .library;
  const PackedExamples packed = pack_examples(library);
  const auto n = library.examples.size(), joints = library.skeleton.names.size();
  std::vector<double> weights(n, 0.9 / static_cast<double>(n));
  weights[n / 2] += 0.1;
  const auto motion = BlendedMotion::create(library, packed, weights);
  if (!motion) return;
  auto scratch = motion->make_scratch();
  const std::size_t blocks = scratch.reference.size();
  std::vector<PoseBlock> poses(kFrames * blocks);
  std::vector<PoseBlock> space(static_cast<std::size_t>(model_scratch(static_cast<int>(joints))));
  std::vector<Vec3f> positions(kFrames * joints);
  std::vector<Quatf> orientations(positions.size());
  std::vector<Transform> plain(joints), plain_space(5 * joints);
  const auto time = [&](int f) { return motion->duration() * f / (kFrames - 1); };
  const auto pose_all = [&] {
    for (int f = 0; f < kFrames; ++f) {
      motion->pose(time(f), std::span(poses).subspan(static_cast<std::size_t>(f) * blocks, blocks),
                   scratch);
    }
  };
  const Measure measure(library, packed);
  auto measure_space = measure.make_scratch();
  std::vector<double> values(library.parameters.size()), jacobian(values.size() * n);
  Vec3 checked = Vec3::Zero();
  std::vector<Part> parts = {
      {"frame, plain", kFrames,
       [&] {
         for (int f = 0; f < kFrames; ++f) {
           plain_pose(library, packed, weights, motion->generic_at(time(f)), plain, plain_space);
           checked += plain.back().position;
         }
       }},
      {"frame, to the parents", kFrames, pose_all},
      {"frame, to the world", kFrames,
       [&] {
         pose_all();
         local_to_model({library.skeleton.parents, poses, space}, positions, orientations);
       }},
      {"one frame, to the world", 1,
       [&] {
         motion->pose(time(20), std::span(poses).first(blocks), scratch);
         local_to_model({library.skeleton.parents, std::span(poses).first(blocks), space},
                        std::span(positions).first(joints), std::span(orientations).first(joints));
       }},
      {"measure", 16,
       [&] {
         for (int i = 0; i < 16; ++i) (void)measure(weights, values, {}, measure_space).ok();
       }},
      {"measure with derivatives", 16,
       [&] {
         for (int i = 0; i < 16; ++i) (void)measure(weights, values, jacobian, measure_space).ok();
       }},
      {"beginning a motion", 1,
       [&] { (void)BlendedMotion::create(library, packed, weights).ok(); }}};
  measure_parts(parts);
  std::printf("%zu examples, %zu joints\n", n, joints);
  for (const Part& part : parts) {
    std::printf("  %-26s %7.2f us\n", part.name.c_str(), part.microseconds());
  }
  std::printf("  frame, plain / ours: %.1f\n", parts[0].microseconds() / parts[2].microseconds());
  std::printf("  hash of the poses: %s\n", hex(xxh3(std::as_bytes(std::span(poses)))).c_str());
}

}  // namespace

int main() {
  run(false);
  run(true);
  return 0;
}
