// Captures written as BVH and read again: the motion differs by no more than the printed digits
// make. Would break: digits that are lost, bones that stretch written as if they did not, angles
// that go wrong near gimbal lock.

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>

#include "core/file.h"
#include "corpus/bvh/corpus_files.h"
#include "formats/bvh/bvh_reader.h"
#include "formats/bvh/bvh_writer.h"
#include "math/quaternion.h"

namespace krok {
namespace {

using test::kBvhFolder;
using test::text_of_file;

struct Errors {
  double position = 0;  // metres
  double angle = 0;     // degrees
};

Errors round_trip(const Clip& clip, const bvh::WriteOptions& writing) {
  const std::string path =
      testing::TempDir() + "krok_round_trip_" + std::to_string(getpid()) + ".bvh";
  auto output = OutputFile::create(path);
  EXPECT_TRUE(output.ok());
  EXPECT_TRUE(bvh::write(clip, writing, *output).ok());
  EXPECT_TRUE(output->commit().ok());
  bvh::ReadOptions reading;
  reading.unit = Unit{writing.unit_metres, "given"};
  reading.up = Direction::plus_y;
  reading.forward = Direction::plus_z;
  reading.positions = bvh::Positions::absolute;
  reading.strictness = Strictness::strict;
  const auto back = bvh::read(text_of_file(path), path, reading);
  std::filesystem::remove(path);
  if (!back.ok()) {
    ADD_FAILURE() << back.error().message;
    return {};
  }
  EXPECT_EQ(difference_in_structure(clip.skeleton, back->clip.skeleton), "");
  EXPECT_EQ(clip.frame_count(), back->clip.frame_count());
  if (clip.positions.size() != back->clip.positions.size()) return {};
  Errors errors;
  const auto joints = static_cast<std::size_t>(clip.joint_count());
  for (std::size_t i = 0; i < clip.positions.size(); ++i) {
    const Vec3f apart = clip.positions[i] - back->clip.positions[i];
    errors.position = std::max(errors.position, static_cast<double>(apart.norm()));
    if (clip.skeleton.end_sites[i % joints] != 0) continue;  // has no turn of its own
    const double angle = angle_between(clip.orientations[i].cast<double>(),
                                       back->clip.orientations[i].cast<double>());
    errors.angle = std::max(errors.angle, angle / kRadiansPerDegree);
  }
  return errors;
}

// The largest coordinate: what floats can tell apart goes with it.
double reach_of(const Clip& clip) {
  float reach = 0;
  for (const Vec3f& position : clip.positions) {
    reach = std::max(reach, position.cwiseAbs().maxCoeff());
  }
  return reach;
}

TEST(RoundTrip, DiffersByThePrintedDigitsAndTheRoundingOfFloats) {
  if (!std::filesystem::exists(kBvhFolder)) GTEST_SKIP() << "skipped: no corpus at " << kBvhFolder;
  for (const char* name :
       {"ipi_smartbody/Center.bvh", "pybvh/bvh_test3.bvh", "makehuman/face-poseunits.bvh",
        "animated_drawings/cmu1_jumping_jacks.bvh", "iclone_cmu/002_03.bvh",
        "fairmotion/pfnn_hierarchy.bvh", "secondlife_opencollar/~run.bvh"}) {
    const auto capture = bvh::read(text_of_file(kBvhFolder + name), name);
    ASSERT_TRUE(capture.ok()) << name;
    const Clip& clip = capture->clip;
    const double reach = reach_of(clip);
    for (int digits = 3; digits <= 9; ++digits) {
      bvh::WriteOptions writing;
      writing.decimals = digits;
      const Errors errors = round_trip(clip, writing);
      const double last = std::pow(10.0, -digits);
      EXPECT_LE(errors.position, 0.1 * last + 5e-7 * std::max(1.0, reach)) << name << digits;
      EXPECT_LE(errors.angle, 8.0 * last + 1e-5) << name << digits;  // five digits of a degree
    }
  }
}

// A chain of joints in all poses that are hard to write: both kinds of gimbal lock and their
// neighbourhood, half turns, and bones of no length.
Clip hard_poses() {
  Clip clip;
  clip.rate = 60;
  Transform at;
  clip.skeleton.add("root", -1, at);
  for (int j = 1; j < 6; ++j) {
    if (j != 3) at.position += Vec3(0.1, 0.25, 0);  // joint 3 stands where joint 2 does
    clip.skeleton.add("joint" + std::to_string(j), j - 1, at);
  }
  at.position += Vec3(0, 0.3, 0);
  clip.skeleton.add("joint5_end", 5, at, true);
  const std::vector<double> angles = {0, 90, -90, 180, 89.9999, 90.0001, -89.99999, 1e-4, 45, 270};
  const auto joints = static_cast<std::size_t>(clip.joint_count());
  clip.resize(static_cast<int>(angles.size() * angles.size()));
  std::vector<Transform> local(joints), world(joints);
  for (std::size_t a = 0; a < angles.size(); ++a) {
    for (std::size_t b = 0; b < angles.size(); ++b) {
      for (std::size_t j = 0; j < joints; ++j) {
        const int parent = clip.skeleton.parents[j];
        local[j].position = clip.skeleton.reference[j].position;
        if (parent >= 0) {
          local[j].position -= clip.skeleton.reference[static_cast<std::size_t>(parent)].position;
        }
        local[j].orientation =
            clip.skeleton.end_sites[j] != 0
                ? Quat::Identity()
                : axis_rotation(Axis::x, angles[(a + j) % 10] * kRadiansPerDegree) *
                      axis_rotation(Axis::y, angles[b] * kRadiansPerDegree) *
                      axis_rotation(Axis::z, angles[(b + j) % 10] * kRadiansPerDegree);
        world[j] = parent < 0 ? local[j] : world[static_cast<std::size_t>(parent)] * local[j];
      }
      clip.set_pose(static_cast<int>(a * angles.size() + b), world);
    }
  }
  return clip;
}

constexpr EulerOrder kOrders[] = {{Axis::x, Axis::y, Axis::z}, {Axis::x, Axis::z, Axis::y},
                                  {Axis::y, Axis::x, Axis::z}, {Axis::y, Axis::z, Axis::x},
                                  {Axis::z, Axis::x, Axis::y}, {Axis::z, Axis::y, Axis::x}};

TEST(RoundTrip, HoldsNearGimbalLockInAllOrders) {
  const Clip clip = hard_poses();
  for (const EulerOrder& order : kOrders) {
    bvh::WriteOptions writing;
    writing.order = order;
    const Errors errors = round_trip(clip, writing);
    EXPECT_LE(errors.position, 1e-6);
    EXPECT_LE(errors.angle, 5e-5);  // a millionth of a radian
  }
}

TEST(RoundTrip, HoldsWhereBonesStretch) {
  for (const double stretch : {3e-6, 1e-4, 0.05}) {
    Clip clip = hard_poses();
    const auto joints = static_cast<std::size_t>(clip.joint_count());
    for (std::size_t i = 0; i < clip.positions.size(); ++i) {
      const std::size_t joint = i % joints;
      if (joint < 2) continue;  // all beyond the first bone moves with it
      const double frame = static_cast<double>(i / joints);
      clip.positions[i] += (stretch * std::sin(frame) * Vec3(1, 0.3, -0.7)).cast<float>();
    }
    const Errors errors = round_trip(clip, {});
    EXPECT_LE(errors.position, 3e-6) << stretch;
    EXPECT_LE(errors.angle, 5e-5) << stretch;
  }
}

TEST(RoundTrip, DigitsMeanTheSameLengthInEveryUnit) {
  const Clip clip = hard_poses();
  for (const double unit : {1.0, 0.1, 0.01, 0.001, 0.0254, 0.3048, 0.0254 / 0.45}) {
    bvh::WriteOptions writing;
    writing.unit_metres = unit;
    EXPECT_LE(round_trip(clip, writing).position, 1e-6) << unit;
  }
}

}  // namespace
}  // namespace krok
