// Would fail if a blend were not the weighted mean of its poses, if the sign of a quaternion told,
// or if an instruction set, a tail or the number of terms changed the result.

#include "pose/packed_pose.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>

#include "poses.h"

namespace krok {
namespace {

struct Blended {
  std::vector<PoseBlock> pose;
  float agreement = 0;
};

Blended blended(std::span<const BlendTerm> terms, std::span<const PoseBlock> reference) {
  Blended result{std::vector<PoseBlock>(reference.size()), 0};
  result.agreement = blend_poses(terms, reference, result.pose);
  return result;
}

// A clip of one frame with one joint of each of the rotations' number.
PackedClip still(const std::vector<Quat>& rotations) {
  std::vector<Transform> local(rotations.size());
  for (std::size_t j = 0; j < local.size(); ++j) local[j].orientation = rotations[j];
  PackedClip clip;
  clip.joints = static_cast<int>(local.size());
  clip.frames = 1;
  clip.blocks.resize(static_cast<std::size_t>(pose_blocks(clip.joints)));
  pack_pose(local, clip.blocks);
  return clip;
}

// The blend of single rotations with the identity as reference.
Quat mean_of(const std::vector<Quat>& rotations, const std::vector<double>& weights) {
  std::vector<PackedClip> clips;
  std::vector<BlendTerm> terms;
  for (const Quat& q : rotations) clips.push_back(still({q}));
  for (std::size_t i = 0; i < clips.size(); ++i) {
    terms.push_back({&clips[i], 0, static_cast<float>(weights[i])});
  }
  const PackedClip reference = still({Quat::Identity()});
  return test::unpacked(blended(terms, reference.blocks).pose, 1)[0].orientation;
}

// The rotation that maximises sum_i w_i (q . q_i)^2: the largest eigenvector of sum w q q^T.
Quat markley_mean(const std::vector<Quat>& rotations, const std::vector<double>& weights) {
  Mat4 sum = Mat4::Zero();
  for (std::size_t i = 0; i < rotations.size(); ++i) {
    sum += weights[i] * rotations[i].coeffs() * rotations[i].coeffs().transpose();
  }
  return Quat(Vec4(Eigen::SelfAdjointEigenSolver<Mat4>(sum).eigenvectors().col(3)));
}

// Where the weighted sum of the rotation vectors to all the others vanishes.
Quat karcher_mean(const std::vector<Quat>& rotations, const std::vector<double>& weights) {
  Quat mean = rotations[0];
  for (int round = 0; round < 100; ++round) {
    Vec3 step = Vec3::Zero();
    for (std::size_t i = 0; i < rotations.size(); ++i) {
      step += weights[i] * rotation_vector(mean.conjugate() * rotations[i]);
    }
    mean = normalized_or_identity(mean * from_rotation_vector(step));
  }
  return mean;
}

struct Errors {
  double markley = 0, karcher = 0;
};

// The largest angles to the textbook's means, over sets of rotations within `spread` of a centre.
Errors errors_at(double spread) {
  std::mt19937 random(3u);
  const auto unit = [&] { return static_cast<double>(random() % 2001) / 1000.0 - 1.0; };
  Errors worst;
  for (int set = 0; set < 200; ++set) {
    const Quat centre = from_rotation_vector(0.5 * Vec3(unit(), unit(), unit()));
    std::vector<Quat> rotations;
    std::vector<double> weights;
    double sum = 0;
    for (int i = 0; i < 5; ++i) {
      rotations.push_back(centre *
                          from_rotation_vector(spread * Vec3(unit(), unit(), unit()).normalized()));
      weights.push_back(1.05 + unit());
      sum += weights.back();
    }
    for (double& weight : weights) weight /= sum;
    const Quat mean = mean_of(rotations, weights);
    worst.markley = std::max(worst.markley, angle_between(mean, markley_mean(rotations, weights)));
    worst.karcher = std::max(worst.karcher, angle_between(mean, karcher_mean(rotations, weights)));
  }
  return worst;
}

TEST(BlendPoses, RotationsAgreeWithTheMarkleyAndKarcherMeans) {
  const Errors near = errors_at(0.1), wide = errors_at(0.4), widest = errors_at(0.8);
  // The figures behind the bounds: 7.4e-5, 2.4e-5 and 0.044, 0.013 rad.
  EXPECT_LT(near.markley, 1e-4);
  EXPECT_LT(near.karcher, 4e-5);
  EXPECT_LT(widest.markley, 0.05);
  EXPECT_LT(widest.karcher, 0.015);
  // The third power: twice the spread, eight times the error.
  EXPECT_NEAR(std::log2(widest.markley / wide.markley), 3, 0.35);
  EXPECT_NEAR(std::log2(widest.karcher / wide.karcher), 3, 0.35);
}

TEST(BlendPoses, TwoRotationsAtHalfAreTheMiddleOfTheArc) {
  const Quat a = from_rotation_vector(Vec3(0.3, 0.2, -0.4));
  for (const double angle : {1e-4, 0.5, 1.5, 2.5}) {
    const Quat b = a * from_rotation_vector(angle * Vec3(0.6, 0, 0.8));
    EXPECT_LT(angle_between(mean_of({a, b}, {0.5, 0.5}), slerp(a, b, 0.5)), 5e-7) << angle;
  }
}

TEST(BlendPoses, AMotionWithItselfIsItself) {
  const Clip clip = test::random_clip(23, 30, 7u);
  const PackedClip packed = pack_clip(clip);
  const auto reference = packed_reference(clip.skeleton);
  std::vector<PoseBlock> alone(reference.size());
  for (const double time : {0.0, 0.11, 0.5, 0.77, 0.9}) {
    sample_pose(packed, time, alone);
    for (const std::vector<float>& weights :
         {std::vector<float>{1}, {0.25f, 0.75f}, {0.1f, 0.2f, 0.3f, 0.4f}, {1.5f, -0.5f}}) {
      std::vector<BlendTerm> terms;
      for (const float weight : weights) terms.push_back({&packed, time, weight});
      const auto result = blended(terms, reference);
      EXPECT_NEAR(result.agreement, 1, 1e-6);
      const auto expected = test::unpacked(alone, packed.joints);
      const auto mixed = test::unpacked(result.pose, packed.joints);
      for (std::size_t j = 0; j < expected.size(); ++j) {
        EXPECT_LT((mixed[j].position - expected[j].position).norm(), 1e-6);
        EXPECT_LT(angle_between(mixed[j].orientation, expected[j].orientation), 1e-6);
      }
    }
  }
}

TEST(BlendPoses, AWeightOfZeroLeavesTheOtherAlone) {
  const Clip clip = test::random_clip(23, 30, 7u);
  const PackedClip first = pack_clip(clip);
  PackedClip broken = first;
  for (PoseBlock& block : broken.blocks) block.position[0][0] = std::nanf("");
  const auto reference = packed_reference(clip.skeleton);
  const BlendTerm terms[] = {{&first, 0.4, 1}, {&broken, 0.2, 0}};
  const auto both = blended(terms, reference);
  EXPECT_TRUE(test::same_bits(both.pose, blended(std::span(terms, 1), reference).pose));
}

TEST(BlendPoses, TheSignOfAQuaternionDoesNotTell) {
  const Quat a = from_rotation_vector(Vec3(0.3, 0.2, -0.4));
  const Quat b = from_rotation_vector(Vec3(-0.2, 0.9, 0.1));
  const auto negative = [](const Quat& q) { return Quat(Vec4(-q.coeffs())); };
  const Quat expected = mean_of({a, b}, {0.3, 0.7});
  for (const auto& [p, q] :
       {std::pair{negative(a), b}, {a, negative(b)}, {negative(a), negative(b)}}) {
    EXPECT_EQ(mean_of({p, q}, {0.3, 0.7}).coeffs(), expected.coeffs());
  }
}

TEST(BlendPoses, PositionsAreTheWeightedSumWhateverItsWeights) {
  const Clip clip = test::random_clip(17, 10, 8u);
  const PackedClip packed = pack_clip(clip);
  const auto reference = packed_reference(clip.skeleton);
  const BlendTerm terms[] = {{&packed, 0.1, 0.7f}, {&packed, 0.2, 0.9f}};
  const auto sum = test::unpacked(blended(terms, reference).pose, 17);
  std::vector<PoseBlock> one(reference.size()), other(reference.size());
  sample_pose(packed, 0.1, one);
  sample_pose(packed, 0.2, other);
  const auto a = test::unpacked(one, 17), b = test::unpacked(other, 17);
  for (std::size_t j = 0; j < sum.size(); ++j) {
    EXPECT_LT((sum[j].position - 0.7 * a[j].position - 0.9 * b[j].position).norm(), 1e-6);
  }
}

TEST(BlendPoses, RotationsThatCancelBecomeTheReferences) {
  // Half turns about x and -x lie on the border of the identity's hemisphere, and cancel.
  const PackedClip one = still({Quat(0, 1, 0, 0)}), other = still({Quat(0, -1, 0, 0)});
  const PackedClip reference = still({Quat::Identity()});
  const BlendTerm terms[] = {{&one, 0, 0.5f}, {&other, 0, 0.5f}};
  const auto result = blended(terms, reference.blocks);
  EXPECT_EQ(test::unpacked(result.pose, 1)[0].orientation.coeffs(), Quat::Identity().coeffs());
  EXPECT_EQ(result.agreement, 0);
}

TEST(BlendPoses, WithoutTermsTheReferencesRotations) {
  const Clip clip = test::random_clip(3, 1, 8u);
  const auto reference = packed_reference(clip.skeleton);
  const auto result = blended({}, reference);
  EXPECT_EQ(result.agreement, 0);
  for (int j = 0; j < 3; ++j) {
    EXPECT_EQ(result.pose[0].rotation[1][j], reference[0].rotation[1][j]);
    EXPECT_EQ(result.pose[0].position[1][j], 0);
  }
}

TEST(BlendPoses, NaNInOneJointLeavesTheOthers) {
  PackedClip clip = pack_clip(test::random_clip(5, 1, 8u));
  clip.blocks[0].rotation[2][3] = std::nanf("");
  const auto reference = packed_reference(test::random_clip(5, 1, 8u).skeleton);
  const BlendTerm terms[] = {{&clip, 0, 1}};
  const auto result = blended(terms, reference);
  for (int i = 0; i < 4; ++i) {
    EXPECT_EQ(result.pose[0].rotation[i][3], reference[0].rotation[i][3]);
    EXPECT_TRUE(std::isfinite(result.pose[0].rotation[i][2]));
  }
  EXPECT_EQ(result.agreement, 0);
}

TEST(BlendPoses, AgreementIsTheCosineOfAQuarterOfTheAngle) {
  const PackedClip reference = still({Quat::Identity(), Quat::Identity()});
  for (const double angle : {0.0, 0.5, 1.5, 3.0}) {
    const Quat q = from_rotation_vector(Vec3(0, angle, 0));
    const PackedClip one = still({Quat::Identity(), Quat::Identity()}),
                     other = still({Quat::Identity(), q});
    const BlendTerm terms[] = {{&one, 0, 0.5f}, {&other, 0, 0.5f}};
    EXPECT_NEAR(blended(terms, reference.blocks).agreement, std::cos(angle / 4), 1e-6) << angle;
  }
}

TEST(BlendPoses, EveryInstructionSetGivesTheBitsOfTheReference) {
  // 20 terms go in two rounds.
  for (const int terms_count : {1, 2, 8, 16, 17, 20, 40}) {
    for (const int joints : {1, 7, 8, 9, 16, 33, 60}) {
      std::vector<PackedClip> clips;
      for (unsigned c = 0; c < 3; ++c) {
        clips.push_back(pack_clip(test::random_clip(joints, 9 + static_cast<int>(c), c)));
      }
      std::vector<BlendTerm> terms;
      for (int i = 0; i < terms_count; ++i) {
        terms.push_back(
            {&clips[static_cast<std::size_t>(i) % 3], 0.013 * i, i % 5 == 4 ? -0.1f : 0.3f});
      }
      const auto reference = packed_reference(test::random_skeleton(joints, 0u));
      std::vector<PoseBlock> expected(reference.size());
      const float agreement = blend_poses_reference(terms, reference, expected);
      test::with_each_simd([&](const char* name) {
        const auto result = blended(terms, reference);
        EXPECT_EQ(result.agreement, agreement) << name;
        EXPECT_TRUE(test::same_bits(result.pose, expected))
            << joints << " joints, " << terms_count << " terms with " << name;
      });
    }
  }
}

TEST(PoseSum, StepByStepIsTheSameBlend) {
  const int joints = 37;
  const Clip a = test::random_clip(joints, 9, 1u), b = test::random_clip(joints, 9, 2u);
  const PackedClip first = pack_clip(a), second = pack_clip(b);
  const auto reference = packed_reference(a.skeleton);
  const BlendTerm terms[] = {{&first, 0.11, 0.4f}, {&second, 0.05, 0.6f}};
  const auto at_once = blended(terms, reference);
  test::with_each_simd([&](const char* name) {
    std::vector<PoseBlock> pose(reference.size()), sum(reference.size());
    clear_sum(sum);
    for (const BlendTerm& term : terms) {
      sample_pose(*term.clip, term.time, pose);
      add_to_sum(pose, term.weight, reference, sum);
    }
    EXPECT_NEAR(finish_sum(reference, sum), at_once.agreement, 1e-6);
    const auto x = test::unpacked(sum, joints), y = test::unpacked(at_once.pose, joints);
    for (std::size_t j = 0; j < x.size(); ++j) {
      EXPECT_LT((x[j].position - y[j].position).norm(), 1e-6) << name;
      EXPECT_LT(angle_between(x[j].orientation, y[j].orientation), 1e-6) << name;
    }
  });
}

}  // namespace
}  // namespace krok
