// Walks of an actor of 29 joints, steps of 27 examples: a frame on level ground, rough ground and
// stairs, beside sampling the same blends alone, and an hour of walking read frame by frame. Rounds
// take turns and the fastest of each counts; what is printed are ratios, which compare across
// machines, times of this one, and a hash of the results.

#include <sys/resource.h>

#include <chrono>
#include <cstdio>
#include <functional>
#include <string>
#include <vector>

#include "core/hash.h"
#include "terrain/shapes.h"
#include "unit/gait/walkers.h"

namespace {

using namespace krok;
using namespace krok::gait;
using test::Way;
using Clock = std::chrono::steady_clock;

constexpr int kRounds = 7;

double seconds_since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

// The blends of a walk's steps, sampled as often as the walk has frames.
double sampling_alone(const parametric::Synthesiser& steps, int frames) {
  const std::vector<double> asked = {0.6, 0, 0};
  const auto synthesis = steps.weights(asked, {.extrapolate = true});
  const auto motion = steps.motion(synthesis->weights);
  auto scratch = motion->make_scratch();
  std::vector<PoseBlock> pose(scratch.reference.size());
  const auto begin = Clock::now();
  for (int f = 0; f < frames; ++f) {
    motion->pose(motion->duration() * (f % 40) / 40, pose, scratch);
  }
  return seconds_since(begin);
}

void run(const std::string& name, const std::vector<Print>& prints, const Terrain& ground) {
  double walking = 1e9, sampling = 1e9;
  int frames = 0;
  std::uint64_t hash = 0;
  for (int round = 0; round < kRounds; ++round) {
    const auto begin = Clock::now();
    const auto made = walk(test::walking(), prints, ground, {});
    walking = std::min(walking, seconds_since(begin));
    if (!made) {
      std::printf("%s: %s\n", name.c_str(), made.error().message.c_str());
      return;
    }
    frames = made->clip.frame_count();
    hash = xxh3(std::as_bytes(std::span(made->clip.positions)));
    sampling = std::min(sampling, sampling_alone(test::walking()[0].steps(FootSide::left), frames));
  }
  std::printf("%-12s %6d frames, %5.1f us a frame, sampling alone %4.1f, ratio %.1f, hash %016lx\n",
              name.c_str(), frames, walking / frames * 1e6, sampling / frames * 1e6,
              walking / sampling, static_cast<unsigned long>(hash));
}

// As written to a file: blocks of frames, released after use.
void run_hour() {
  const Way way{.steps = 6100, .length = 0.6, .turn = 0.02};
  const auto level = test::Ground([](double, double) { return 0.0; });
  const auto begin = Clock::now();
  const auto made = Walk::plan(test::walking(), test::prints_of(way), level, {});
  if (!made) return;
  const double planned = seconds_since(begin);
  const FrameSource& source = made->frames();
  constexpr int kAtOnce = 256;
  const auto joints = static_cast<std::size_t>(source.joint_count());
  std::vector<Vec3f> positions(kAtOnce * joints);
  std::vector<Quatf> orientations(kAtOnce * joints);
  for (int f = 0; f < source.frame_count; f += kAtOnce) {
    const int some = std::min(kAtOnce, source.frame_count - f);
    if (!source.read(f, some, positions, orientations)) return;
    source.release(f + some);
  }
  rusage usage = {};
  getrusage(RUSAGE_SELF, &usage);
  std::printf("%.0f s of walking: %.2f s (%.2f planning), peak %ld MiB\n", source.duration(),
              seconds_since(begin), planned, usage.ru_maxrss / 1024);
}

}  // namespace

int main() {
  const auto level = test::Ground([](double, double) { return 0.0; });
  const auto rough = terrain::rough({});
  run("level", test::prints_of({.steps = 60}), level);
  run("round bends", test::prints_of({.steps = 60, .turn = 0.15}), level);
  run("rough", test::prints_of({.steps = 60}), **rough);
  run_hour();
}
