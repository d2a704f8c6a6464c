// Mirrored captures, of skeletons that nobody made symmetric: calibrated legs of unequal length,
// reference poses that walk, lie or have one arm up. If these fail, mirrored figures stand beside
// the floor, reach elsewhere or lean.

#include <gtest/gtest.h>

#include <filesystem>

#include "core/file.h"
#include "corpus/bvh/corpus_files.h"
#include "formats/bvh/bvh_reader.h"
#include "math/quaternion.h"
#include "motion/hips_root.h"
#include "motion/mirror.h"

namespace krok {
namespace {

constexpr int kFrames = 200;

// Metres between a joint and the image of its partner, at most.
double distance_from_images(const Clip& clip, const Clip& mirrored, const MirrorPairs& pairs) {
  double most = 0;
  for (int f = 0; f < std::min(clip.frame_count(), kFrames); ++f) {
    for (std::size_t j = 0; j < pairs.partners.size(); ++j) {
      if (pairs.partners[j] == MirrorPairs::kNone) continue;
      Vec3f image = clip.frame_positions(f)[static_cast<std::size_t>(pairs.partners[j])];
      image.x() = -image.x();
      most = std::max<double>(most, (mirrored.frame_positions(f)[j] - image).norm());
    }
  }
  return most;
}

// The same figure with a frame of its motion as the reference pose, the hips as before.
Clip posed(const Clip& clip, int frame) {
  Clip result = clip;
  std::vector<Transform> pose(clip.skeleton.names.size()), local(pose.size());
  clip.get_pose(frame, pose);
  world_to_local(clip.skeleton.parents, pose, local);
  const int hips = carrying_joint(find_roles(clip.skeleton));
  for (std::size_t j = static_cast<std::size_t>(hips) + 1; j < local.size(); ++j) {
    const int parent = clip.skeleton.parents[j];
    result.skeleton.reference[j] =
        result.skeleton.reference[static_cast<std::size_t>(parent)] * local[j];
  }
  return result;
}

TEST(MirroredCaptures, EveryJointIsWhereItsPartnersImageIs) {
  if (!std::filesystem::exists(test::kBvhFolder)) {
    GTEST_SKIP() << "skipped: no corpus at " << test::kBvhFolder;
  }
  int mirrored = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(test::kBvhFolder)) {
    if (entry.path().extension() != ".bvh") continue;
    const std::string path = entry.path().string();
    const std::string text = test::text_of_file(path);
    const auto capture = bvh::read(text, path, {});
    if (!capture || capture->clip.frame_count() == 0) continue;
    ++mirrored;
    const Clip& clip = capture->clip;
    // Pairs are found in the reference pose of the file.
    const MirrorPairs pairs = find_mirror_pairs(clip.skeleton, find_roles(clip.skeleton));
    const Clip other = posed(clip, std::min(clip.frame_count(), kFrames) / 2);
    for (const Clip* one : {&clip, &other}) {
      const Clip result = mirror(*one, pairs);
      EXPECT_LT(distance_from_images(*one, result, pairs), 1e-5) << path;
      EXPECT_TRUE(check(result).ok()) << path;
      const Clip twice = mirror(result, pairs);
      double most = 0, angle = 0;
      for (std::size_t i = 0; i < one->positions.size(); ++i) {
        most = std::max<double>(most, (twice.positions[i] - one->positions[i]).norm());
        angle = std::max(angle, angle_between(twice.orientations[i].cast<double>(),
                                              one->orientations[i].cast<double>()));
      }
      EXPECT_LT(most, 1e-5) << path;
      // A pose of the motion as the reference may have trunks so twisted that a guess decides.
      EXPECT_LT(angle, one == &clip ? 0.001 * kRadiansPerDegree : kPi) << path;
    }
  }
  EXPECT_GT(mirrored, 80);
}

}  // namespace
}  // namespace krok
