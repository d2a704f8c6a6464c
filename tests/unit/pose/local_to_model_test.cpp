// Would fail if a joint landed elsewhere than the chain of its parents puts it, or if a number of
// poses or joints, or an instruction set, changed a single bit.

#include "pose/packed_pose.h"

#include <gtest/gtest.h>

#include <cstring>

#include "poses.h"

namespace krok {
namespace {

struct Transforms {
  std::vector<Vec3f> positions;
  std::vector<Quatf> orientations;
  std::vector<JointMatrix> matrices;
};

Transforms in_model(const Skeleton& skeleton, std::span<const PoseBlock> poses, std::size_t count,
                    bool reference) {
  const std::size_t joints = skeleton.names.size();
  std::vector<PoseBlock> scratch(static_cast<std::size_t>(model_scratch(skeleton.joint_count())));
  // One joint too many at the end, to be left alone.
  Transforms result{std::vector<Vec3f>(count * joints + 1, Vec3f::Constant(-7)),
                    std::vector<Quatf>(count * joints + 1, Quatf(-7, -7, -7, -7)),
                    std::vector<JointMatrix>(count * joints + 1, JointMatrix{{{-7}}})};
  const LocalPoses local{skeleton.parents, poses, scratch};
  const auto positions = std::span(result.positions).first(count * joints);
  const auto orientations = std::span(result.orientations).first(count * joints);
  const auto matrices = std::span(result.matrices).first(count * joints);
  if (reference) {
    local_to_model_reference(local, positions, orientations);
    local_to_model_reference(local, matrices);
  } else {
    local_to_model(local, positions, orientations);
    local_to_model(local, matrices);
  }
  return result;
}

void expect_same(const Transforms& a, const Transforms& b, const std::string& what) {
  EXPECT_EQ(std::memcmp(a.positions.data(), b.positions.data(), a.positions.size() * sizeof(Vec3f)),
            0)
      << what;
  EXPECT_EQ(std::memcmp(a.orientations.data(), b.orientations.data(),
                        a.orientations.size() * sizeof(Quatf)),
            0)
      << what;
  EXPECT_EQ(
      std::memcmp(a.matrices.data(), b.matrices.data(), a.matrices.size() * sizeof(JointMatrix)), 0)
      << what;
}

void expect_model(const Clip& clip, const Transforms& found, double tolerance) {
  const auto joints = clip.skeleton.names.size();
  std::vector<Transform> world(joints);
  for (int f = 0; f < clip.frame_count(); ++f) {
    clip.get_pose(f, world);
    for (std::size_t j = 0; j < joints; ++j) {
      const std::size_t place = static_cast<std::size_t>(f) * joints + j;
      EXPECT_LT((found.positions[place].cast<double>() - world[j].position).norm(), tolerance);
      EXPECT_LT(angle_between(found.orientations[place].cast<double>(), world[j].orientation),
                tolerance);
      EXPECT_NEAR(found.orientations[place].norm(), 1, 1e-5);
      const Mat4 matrix = world[j].matrix();
      for (int r = 0; r < 3; ++r) {
        for (int c = 0; c < 4; ++c) {
          EXPECT_NEAR(found.matrices[place].rows[r][c], matrix(r, c), tolerance);
        }
      }
    }
  }
}

TEST(LocalToModel, PutsJointsWhereTheClipHasThem) {
  for (const int joints : {1, 2, 16, 17, 60}) {
    const Clip clip = test::random_clip(joints, 37, 11u);
    expect_model(clip, in_model(clip.skeleton, pack_clip(clip).blocks, 37, false), 4e-6);
  }
  const Clip human = test::swinging_clip(test::with_turned_joints(test::human_skeleton()), 40, 30);
  expect_model(human, in_model(human.skeleton, pack_clip(human).blocks, 40, false), 4e-6);
}

TEST(LocalToModel, LongChainsLoseLittle) {
  Skeleton chain;
  for (int j = 0; j < 200; ++j) {
    chain.add("j" + std::to_string(j), j - 1,
              {Vec3(0, 0.05 * j, 0), from_rotation_vector(Vec3(0.1 * j, 0, 0.02 * j))});
  }
  Clip clip;
  clip.skeleton = chain;
  clip.resize(1);
  clip.set_pose(0, chain.reference);
  expect_model(clip, in_model(chain, pack_clip(clip).blocks, 1, false), 5e-5);
}

TEST(LocalToModel, EveryInstructionSetGivesTheBitsOfTheReferenceTailsIncluded) {
  for (const int joints : {1, 5, 16, 19, 33}) {
    for (std::size_t count = 0; count <= 35; ++count) {
      const Clip clip = test::random_clip(joints, static_cast<int>(count), 12u);
      std::vector<PoseBlock> poses;
      if (count > 0) poses = pack_clip(clip).blocks;
      const auto expected = in_model(clip.skeleton, poses, count, true);
      test::with_each_simd([&](const char* name) {
        expect_same(
            in_model(clip.skeleton, poses, count, false), expected,
            std::to_string(joints) + " joints, " + std::to_string(count) + " poses with " + name);
      });
    }
  }
}

}  // namespace
}  // namespace krok
