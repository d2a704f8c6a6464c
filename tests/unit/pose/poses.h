#pragma once

#include <bit>
#include <cstdint>
#include <random>
#include <span>
#include <string>
#include <vector>

#include "core/simd.h"
#include "math/quaternion.h"
#include "pose/packed_pose.h"
#include "support/test_scenes.h"

// Skeletons, clips and comparisons for the tests of packed poses.

namespace krok::test {

// A tree of so many joints, each with a parent drawn from those before it.
inline Skeleton random_skeleton(int joints, unsigned seed) {
  std::mt19937 random(seed);
  const auto unit = [&] { return static_cast<double>(random() % 2001) / 1000.0 - 1.0; };
  Skeleton skeleton;
  for (int j = 0; j < joints; ++j) {
    const int parent = j == 0 ? -1 : static_cast<int>(random() % static_cast<unsigned>(j));
    Transform place{0.3 * Vec3(unit(), unit(), unit()),
                    from_rotation_vector(Vec3(unit(), unit(), unit()))};
    if (parent >= 0)
      place.position += skeleton.reference[static_cast<std::size_t>(parent)].position;
    skeleton.add("joint" + std::to_string(j), parent, place);
  }
  return skeleton;
}

inline Clip random_clip(int joints, int frames, unsigned seed, double rate = 30) {
  return swinging_clip(random_skeleton(joints, seed), frames, rate);
}

inline std::vector<Transform> unpacked(std::span<const PoseBlock> pose, int joints) {
  std::vector<Transform> result(static_cast<std::size_t>(joints));
  unpack_pose(pose, result);
  return result;
}

// Bit for bit, so that NaN and -0 count too.
inline bool same_bits(std::span<const PoseBlock> a, std::span<const PoseBlock> b) {
  for (std::size_t i = 0; i < a.size(); ++i) {
    for (int lane = 0; lane < PoseBlock::kLanes; ++lane) {
      const auto differ = [](float x, float y) {
        return std::bit_cast<std::uint32_t>(x) != std::bit_cast<std::uint32_t>(y);
      };
      for (int k = 0; k < 3; ++k) {
        if (differ(a[i].position[k][lane], b[i].position[k][lane])) return false;
      }
      for (int k = 0; k < 4; ++k) {
        if (differ(a[i].rotation[k][lane], b[i].rotation[k][lane])) return false;
      }
    }
  }
  return a.size() == b.size();
}

// Runs `body` with each instruction set that the machine has, handing over its name.
template <typename Body>
void with_each_simd(const Body& body) {
  const Simd most = limit_simd(Simd::avx512);
  for (const auto& [simd, name] :
       {std::pair{Simd::other, "no vectors"}, {Simd::avx2, "AVX2"}, {Simd::avx512, "AVX-512"}}) {
    if (simd > most) continue;
    limit_simd(simd);
    body(name);
  }
  limit_simd(Simd::avx512);
}

}  // namespace krok::test
