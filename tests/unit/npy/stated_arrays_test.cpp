// Arrays that say what they are. If these fail, a motion in another unit, other axes or with
// quaternions in another order comes in as it is, without a word.

#include <gtest/gtest.h>

#include <algorithm>

#include "formats/npy/array_reader.h"
#include "formats/npy/npy.h"
#include "formats/npy/npz_motion.h"
#include "math/quaternion.h"
#include "samples/generator/walk.h"
#include "support/test_scenes.h"

namespace krok::npy {
namespace {

using Named = std::vector<std::pair<std::string, Array>>;

// A walk, each place and each frame of a joint turned and scaled.
struct Walk {
  std::vector<double> places, quaternions, matrices;
  Clip walk = samples::make_walk(samples::WalkOptions())->clip;

  explicit Walk(const Quat& turn = Quat::Identity(), double scale = 1, bool w_first = false) {
    for (std::size_t i = 0; i < walk.positions.size(); ++i) {
      const Vec3 place = scale * (turn * walk.positions[i].cast<double>());
      places.insert(places.end(), place.begin(), place.end());
      const Quat q = (turn * walk.orientations[i].cast<double>()).normalized();
      const Vec4 xyzw = q.coeffs(), wxyz(q.w(), q.x(), q.y(), q.z());
      const Vec4& values = w_first ? wxyz : xyzw;
      quaternions.insert(quaternions.end(), values.begin(), values.end());
      const Eigen::Matrix<double, 3, 3, Eigen::RowMajor> matrix = q.toRotationMatrix();
      matrices.insert(matrices.end(), matrix.data(), matrix.data() + 9);
    }
  }

  Named common() const {
    const auto frames = static_cast<std::size_t>(walk.frame_count());
    const std::size_t joints = walk.skeleton.names.size();
    const std::vector<std::int32_t> parents(walk.skeleton.parents.begin(),
                                            walk.skeleton.parents.end());
    return {{"positions", array_of(places, {frames, joints, 3})},
            {"names", array_of_texts(walk.skeleton.names)},
            {"parents", array_of(parents, {joints})},
            {"rate", array_of(std::span(&walk.rate, 1), {})}};
  }
  Result<Capture> read(const ReadOptions& options = {}) const {
    Named all = common();
    all.emplace_back("quaternions",
                     array_of(quaternions, {all[0].second.shape[0], all[0].second.shape[1], 4}));
    return npy::read(write(std::move(all)).value(), "walk.npz", options);
  }
};

bool has(const Capture& capture, const std::string& code) {
  return std::ranges::any_of(capture.diagnostics, [&](const Diagnostic& one) {
    return one.code == code && one.severity == Severity::warning;
  });
}

TEST(StatedArrays, WhatTheMotionShowsOtherwiseIsWarnedOfAndMayBeGiven) {
  const auto plain = Walk().read();
  ASSERT_TRUE(plain.ok()) << plain.error().message;
  EXPECT_FALSE(has(*plain, "npy-up") || has(*plain, "npy-unit"));
  const Walk centimetres(Quat::Identity(), 100);
  EXPECT_TRUE(has(*centimetres.read(), "npy-unit"));
  const Quat lies = from_rotation_vector(Vec3(kPi / 2, 0, 0));
  const Walk z_up(lies);
  EXPECT_TRUE(has(*z_up.read(), "npy-up"));
  ReadOptions given;
  given.up = Direction::plus_z, given.forward = Direction::minus_y;
  const auto upright = z_up.read(given);
  ASSERT_TRUE(upright.ok());
  EXPECT_FALSE(has(*upright, "npy-up"));
  for (std::size_t i = 0; i < plain->clip.positions.size(); ++i) {
    ASSERT_LT((upright->clip.positions[i] - plain->clip.positions[i]).norm(), 1e-5F) << i;
  }
}

TEST(StatedArrays, AnotherSkeletonIsRefused) {
  ReadOptions options;
  options.columns_name = "smpl24";
  const auto read = Walk().read(options);
  ASSERT_FALSE(read.ok());
  EXPECT_EQ(read.error().code, "npy-skeleton");
}

TEST(StatedArrays, QuaternionsOfAnotherOrderAreRefused) {
  const auto read = Walk(Quat::Identity(), 1, true).read();
  ASSERT_FALSE(read.ok());
  EXPECT_EQ(read.error().code, "npy-rotation");
  EXPECT_NE(read.error().hint.find("numpy.roll"), std::string::npos);
}

TEST(StatedArrays, NamesAndParentsOfTheFileAreTheSkeleton) {
  const Walk arrays;
  Named all = arrays.common();
  const auto& shape = all[0].second.shape;
  all.emplace_back("global_rot_mats", array_of(arrays.matrices, {shape[0], shape[1], 3, 3}));
  const auto read = npy::read(write(std::move(all)).value(), "walk.npz");
  ASSERT_TRUE(read.ok()) << read.error().message;
  EXPECT_EQ(read->clip.skeleton.names, arrays.walk.skeleton.names);
  for (std::size_t i = 0; i < arrays.walk.positions.size(); ++i) {
    ASSERT_LT((read->clip.positions[i] - arrays.walk.positions[i]).norm(), 1e-4F) << i;
  }
}

// Would fail if a long take, unpacked as it is read, were another motion than one that is read
// whole, or a fault in it went unseen.
TEST(StatedArrays, UnpackedInPartsTheyAreTheSame) {
  Clip walk = test::swinging_human(5000);
  for (std::size_t i = 0; i < walk.positions.size(); i += 7) walk.orientations[i].coeffs() *= -1;
  const std::vector<Contact> contacts = {{3, 1.0, 2.5, Vec3::Zero()}, {7, 150, 160, Vec3::Zero()}};
  const auto file = npy::write_motion(frames_of(walk), contacts).value();
  ReadOptions options;
  options.unit = Unit{0.01, "cm"};
  options.up = Direction::plus_z;
  options.forward = Direction::minus_y;
  const auto whole = npy::read(file, "walk.npz", options);
  ASSERT_TRUE(whole.ok()) << whole.error().message;
  const auto opened = npy::open(file, "walk.npz", options);
  ASSERT_TRUE(opened.has_value());
  EXPECT_EQ(opened->clip.frame_count(), 0);
  EXPECT_EQ(opened->clip.provenance.conversions, whole->clip.provenance.conversions);
  EXPECT_EQ(opened->diagnostics.size(), whole->diagnostics.size());
  ASSERT_EQ(opened->keys.contacts.size(), whole->keys.contacts.size());
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    EXPECT_EQ(opened->keys.contacts[i].place, whole->keys.contacts[i].place);
    EXPECT_EQ(opened->keys.contacts[i].end, whole->keys.contacts[i].end);
  }
  for (int pass = 0; pass < 2; ++pass) {
    const auto read = load(opened->frames, 2);
    ASSERT_TRUE(read.ok());
    EXPECT_EQ(read->positions, whole->clip.positions);
    EXPECT_TRUE(std::ranges::equal(
        read->orientations, whole->clip.orientations,
        [](const Quatf& a, const Quatf& b) { return a.coeffs() == b.coeffs(); }));
  }
  const auto transforms = walk.positions.size();
  EXPECT_TRUE(npy::open(file, "walk.npz", options, transforms).has_value());
  EXPECT_FALSE(npy::open(file, "walk.npz", options, transforms + 1).has_value());

  auto damaged = file;
  damaged[damaged.size() / 2] ^= std::byte{1};
  EXPECT_FALSE(npy::open(damaged, "walk.npz", options).has_value());
  walk.positions[4900 * 20].x() = NAN;
  const auto faulty = npy::write_motion(frames_of(walk), {}).value();
  const auto late = npy::open(faulty, "walk.npz", options);
  EXPECT_TRUE(!late || !read_through(late->frames, 1));
}

// Would fail if noise-free places came out centimetres off, for a parent that is not one, unsaid.
TEST(StatedArrays, ParentsThatAreNoneAreWarnedOf) {
  const Walk walk;
  ReadOptions options;
  options.columns.emplace();
  const Skeleton& skeleton = walk.walk.skeleton;
  for (std::size_t j = 0; j < skeleton.names.size(); ++j) {
    const int parent = skeleton.parents[j];
    auto& joint = options.columns->joints.emplace_back();
    joint.name = skeleton.names[j];
    if (parent >= 0) joint.parent = skeleton.names[static_cast<std::size_t>(parent)];
  }
  const auto read = [&] {
    Named places = {walk.common()[0], walk.common()[3]};
    return npy::read(write(std::move(places)).value(), "walk.npz", options);
  };
  EXPECT_FALSE(has(*read(), "npy-fit"));
  for (auto& joint : options.columns->joints) {
    if (joint.name == "LeftFoot") joint.parent = "Hips";
  }
  EXPECT_TRUE(has(*read(), "npy-fit"));
}

// Would fail if a mirrored body walked backwards on knees that bend backwards without a word.
TEST(StatedArrays, MirroredPlacesAreWarnedOf) {
  for (const double sign : {1.0, -1.0}) {
    Walk walk;
    for (std::size_t i = 0; i < walk.places.size(); i += 3) walk.places[i] *= sign;
    const auto read = npy::read(write(walk.common()).value(), "walk.npz");
    ASSERT_TRUE(read.ok()) << read.error().message;
    EXPECT_EQ(has(*read, "npy-sides"), sign < 0);
  }
}

TEST(StatedArrays, PosesInDegreesAreRefused) {
  const std::vector<double> poses(66, 40);
  const auto read = npy::read(write(Named{{"poses", array_of(poses, {1, 66})}}).value(), "p.npz");
  ASSERT_FALSE(read.ok());
  EXPECT_NE(read.error().hint.find("numpy.radians"), std::string::npos);
}

}  // namespace
}  // namespace krok::npy
