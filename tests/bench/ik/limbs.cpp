// Two bones in closed form: legs of random lengths to random targets and poles.

#include <algorithm>
#include <cstdio>
#include <random>
#include <vector>

#include "bench/ik/parts.h"
#include "core/hash.h"
#include "ik/two_bone.h"

namespace krok::bench {

void two_bones() {
  constexpr int kCount = 1000, kRounds = 400;
  std::mt19937_64 random(3);
  const auto unit = [&] { return static_cast<double>(random() >> 11) * 0x1p-52 - 1; };
  std::vector<TwoBoneChain> chains(kCount);
  std::vector<TwoBoneGoal> goals(kCount);
  for (std::size_t i = 0; i < kCount; ++i) {
    chains[i].middle = Vec3(0.1 * unit(), -0.45, 0.1 * unit());
    chains[i].end = chains[i].middle + Vec3(0.1 * unit(), -0.42, 0.1 * unit());
    chains[i].hinge = Vec3::UnitX();
    goals[i].target = Vec3(unit(), unit(), unit());
    goals[i].pole = Vec3(unit(), unit(), 1);
  }
  std::vector<Vec3> ends(kCount);
  double best = 1;
  for (int round = 0; round < kRounds; ++round) {
    const double begin = seconds();
    for (std::size_t i = 0; i < kCount; ++i) {
      const TwoBoneSolution solution = solve_two_bone(chains[i], goals[i]);
      ends[i] = solution.end + solution.middle_rotation.vec() + solution.root_rotation.vec();
    }
    best = std::min(best, (seconds() - begin) / kCount);
  }
  std::printf("two bones: %.0f ns a solution; hash %s\n", 1e9 * best,
              hex(xxh3(std::as_bytes(std::span(ends)))).c_str());
}

}  // namespace krok::bench
