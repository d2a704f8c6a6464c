#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <random>
#include <string>
#include <vector>

#include "core/file.h"
#include "formats/bvh/bvh_reader.h"
#include "math/quaternion.h"
#include "motion/local_motion.h"
#include "motion/sample.h"
#include "support/this_build.h"
#include "unit/blend/rigged_walks.h"

// The motions that promises of headers are tested on: random trees with random axes that tumble,
// the four rigs, the captures of the samples and, where it is, those of the corpus.

namespace krok::test {

struct NamedMotion {
  std::string name;
  Clip clip;
};

class Dice {
 public:
  explicit Dice(unsigned seed) : random_(seed) {}
  double between(double low, double high) {
    return low + (high - low) * (static_cast<double>(random_()) / 4294967296.0);
  }
  int below(int count) { return static_cast<int>(random_() % static_cast<unsigned>(count)); }
  Vec3 vector(double size) {
    return {between(-size, size), between(-size, size), between(-size, size)};
  }
  Quat rotation() { return from_rotation_vector(vector(3)); }

 private:
  std::mt19937 random_;
};

// One that `repeats` is at its end as at its beginning, further along.
inline Clip random_motion(Dice& dice, int frames, bool repeats = false) {
  Clip clip;
  clip.rate = dice.between(10, 120);
  const int joints = 1 + dice.below(25);
  for (int j = 0; j < joints; ++j) {
    const int parent = j == 0 ? -1 : dice.below(j);
    const Vec3 from = parent < 0
                          ? Vec3::Zero()
                          : clip.skeleton.reference[static_cast<std::size_t>(parent)].position;
    clip.skeleton.add("joint" + std::to_string(j), parent,
                      {from + dice.vector(0.4), dice.rotation()});
  }
  LocalMotion motion;
  motion.joints = joints;
  motion.frames = frames;
  const auto count = static_cast<std::size_t>(joints) * static_cast<std::size_t>(frames);
  motion.orientations.resize(count);
  motion.positions.resize(count);
  for (int j = 0; j < joints; ++j) {
    const Transform rest = clip.skeleton.reference_local(j);
    const Vec3 swing = dice.vector(1), sway = dice.vector(0.5), way = dice.vector(0.02);
    const double pace =
        repeats ? 2 * kPi * (1 + dice.below(2)) / (frames - 1) : dice.between(0.05, 0.3);
    const double other_pace = repeats ? 2 * pace : 1.7 * pace;
    for (int f = 0; f < frames; ++f) {
      const Quat turn = from_rotation_vector(std::sin(pace * f) * swing) *
                        from_rotation_vector(std::cos(other_pace * f) * sway);
      motion.set(j, f,
                 {j == 0 ? Vec3(rest.position + f * way) : rest.position, rest.orientation * turn});
    }
  }
  set_local_motion(motion, clip);
  return clip;
}

// At most so many frames from the middle of a capture; nothing if it cannot be read.
inline std::vector<NamedMotion> capture_at(const std::filesystem::path& path, int frames) {
  const auto file = InputFile::open(path.string());
  if (!file) return {};
  auto capture = bvh::read(file->text(), path.string(), {});
  if (!capture || capture->clip.frame_count() < 30) return {};
  const int count = std::min(frames, capture->clip.frame_count());
  const int first = (capture->clip.frame_count() - count) / 2;
  return {{path.filename().string(), cut(capture->clip, first, first + count - 1)}};
}

// Of people: the rigs, the samples, every few of the corpus.
inline const std::vector<NamedMotion>& people() {
  static const std::vector<NamedMotion> all = [] {
    std::vector<NamedMotion> motions;
    const blend::KeyedWalk walk = blend::keyed_walk(blend::slow_walk());
    for (const auto rig :
         {blend::Rig::hips, blend::Rig::static_root, blend::Rig::ground_root, blend::Rig::lying}) {
      motions.push_back({"rig " + std::to_string(static_cast<int>(rig)),
                         blend::with_other_axes(blend::rigged(walk, rig)).clip});
    }
    const auto add = [&](const std::filesystem::path& path, int frames) {
      for (NamedMotion& motion : capture_at(path, frames)) motions.push_back(std::move(motion));
    };
    for (const char* name : {"walk.bvh", "turn.bvh", "stairs.bvh"}) {
      add(test::source_folder() + "/samples/captures/" + name, 300);
    }
    std::vector<std::filesystem::path> captures;
    std::error_code missing;
    const std::string corpus = test::corpus_folder() + "/bvh/";
    for (std::filesystem::recursive_directory_iterator at(corpus, missing), end; at != end;
         at.increment(missing)) {
      if (at->path().extension() == ".bvh" && at->file_size() < 3'000'000) {
        captures.push_back(at->path());
      }
    }
    std::ranges::sort(captures);
    constexpr std::size_t kEvery = 6;
    for (std::size_t i = 0; i < captures.size(); i += kEvery) add(captures[i], 120);
    return motions;
  }();
  return all;
}

// Those and random ones.
inline const std::vector<NamedMotion>& promised_motions() {
  static const std::vector<NamedMotion> all = [] {
    std::vector<NamedMotion> motions = people();
    Dice dice(44);
    for (int i = 0; i < 20; ++i) {
      motions.push_back({"random " + std::to_string(i), random_motion(dice, 40)});
    }
    return motions;
  }();
  return all;
}

inline bool same_bits(const Clip& a, const Clip& b) {
  const auto same = [](const auto& x, const auto& y) {
    return x.size() == y.size() &&
           (x.empty() || std::memcmp(x.data(), y.data(), x.size() * sizeof(x[0])) == 0);
  };
  return a.rate == b.rate && same(a.positions, b.positions) && same(a.orientations, b.orientations);
}

// The largest distance or angle between joints of two motions of one skeleton: metres, radians.
inline double metres_apart(const Clip& a, const Clip& b) {
  if (a.positions.size() != b.positions.size()) return 1e9;
  double most = 0;
  for (std::size_t i = 0; i < a.positions.size(); ++i) {
    most = std::max<double>(most, (a.positions[i] - b.positions[i]).norm());
    most = std::max(
        most, angle_between(a.orientations[i].cast<double>(), b.orientations[i].cast<double>()));
  }
  return most;
}

// Metres: how far from the origin a motion reaches, which float rounding is in proportion to.
inline double extent(const Clip& clip) {
  double most = 1;
  for (const Vec3f& position : clip.positions) most = std::max<double>(most, position.norm());
  return most;
}

}  // namespace krok::test
