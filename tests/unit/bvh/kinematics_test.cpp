// If these fail, frames come out differently on another machine, or turned by other angles than the
// file says.

#include "formats/bvh/kinematics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <functional>
#include <random>

#include "core/simd.h"
#include "formats/bvh/half_angle.h"

namespace krok::bvh {
namespace {

constexpr std::size_t kAtOnce = Kinematics::kFramesAtOnce;

TEST(HalfAngle, IsAsAccurateAsADoubleCanBe) {
  double largest = 0;
  for (int i = -400000; i <= 400000; ++i) {
    const double degrees = i * 0.0018123;
    const long double half =
        static_cast<long double>(degrees) * (3.14159265358979323846264338327950288L / 360.0L);
    const HalfAngle found = half_angle(degrees);
    largest = std::max(largest, static_cast<double>(std::abs(found.sine - sinl(half))));
    largest = std::max(largest, static_cast<double>(std::abs(found.cosine - cosl(half))));
  }
  EXPECT_LT(largest, 2e-16);
}

TEST(HalfAngle, IsExactWhereItCanBe) {
  const double cosines[] = {1, 0, -1, 0};
  for (int half_turns = -9; half_turns <= 9; ++half_turns) {
    const HalfAngle found = half_angle(180.0 * half_turns);
    const auto quarter = static_cast<std::size_t>(half_turns & 3);
    EXPECT_EQ(found.cosine, cosines[quarter]) << half_turns;
    EXPECT_EQ(found.sine, cosines[(quarter + 3) % 4]) << half_turns;
  }
  EXPECT_EQ(half_angle(0).sine, 0);
  EXPECT_EQ(half_angle(-0.0).cosine, 1);
}

TEST(HalfAngle, TakesAnyNumberOfTurns) {
  for (const double degrees : {720.0 * 1e9 + 90, 0x1p60 * 720, 1e300, -0x1p50 * 720 - 720}) {
    const HalfAngle found = half_angle(degrees);
    const HalfAngle near = half_angle(std::fmod(degrees, 720));
    EXPECT_NEAR(found.sine, near.sine, 1e-15) << degrees;
    EXPECT_NEAR(found.cosine, near.cosine, 1e-15) << degrees;
  }
}

// A tree with joints of all kinds of channels, and one without any.
Hierarchy odd_hierarchy() {
  using Kind = ChannelKind;
  Hierarchy hierarchy;
  const auto add = [&](int parent, const Vec3& offset,
                       const std::vector<std::pair<Kind, Axis>>& channels) {
    Hierarchy::Joint joint;
    joint.name = "joint" + std::to_string(hierarchy.joints.size());
    joint.parent = parent;
    joint.offset = offset;
    joint.first_channel = hierarchy.channels.size();
    joint.channel_count = channels.size();
    for (const auto& [kind, axis] : channels) {
      hierarchy.channels.push_back({kind, axis, static_cast<int>(hierarchy.joints.size())});
    }
    hierarchy.joints.push_back(joint);
  };
  const auto turn = Kind::rotation;
  const auto move = Kind::position;
  add(-1, {0, 1, 0},
      {{move, Axis::x},
       {move, Axis::y},
       {move, Axis::z},
       {turn, Axis::z},
       {turn, Axis::x},
       {turn, Axis::y}});
  add(0, {1, 2, 3}, {{turn, Axis::x}, {turn, Axis::y}, {turn, Axis::z}});
  add(1, {0.5, 0, 0},
      {{turn, Axis::y}, {move, Axis::x}, {Kind::ignored, Axis::x}, {turn, Axis::y}});
  add(2, {0, 0.25, 0}, {});
  add(0, {-1, 0, 0}, {{turn, Axis::z}});
  return hierarchy;
}

void expect_same_kinematics(const Kinematics& kinematics, std::size_t channels, std::size_t frames,
                            const std::function<double()>& value, bool near) {
  struct alignas(64) Line {
    double values[kAtOnce];
  };
  std::vector<Line> values(channels);
  for (Line& line : values) {
    for (double& v : line.values) v = value();
  }
  const std::size_t joints = kinematics.joint_count();
  std::vector<Vec3f> positions(frames * joints);
  std::vector<Quatf> orientations(frames * joints);
  std::vector<double> scratch;
  const auto fill = [&] {
    EXPECT_EQ(kinematics.poses({values[0].values, channels * kAtOnce}, frames, scratch, positions,
                               orientations),
              near);
  };
  for (const Simd simd : {Simd::other, Simd::avx2}) {
    limit_simd(simd);
    fill();
    const auto before = std::pair(positions, orientations);
    limit_simd(Simd::avx512);
    fill();
    EXPECT_EQ(before.first, positions);
    for (std::size_t i = 0; i < orientations.size(); ++i) {
      EXPECT_EQ(before.second[i].coeffs(), orientations[i].coeffs());
    }
  }
  std::vector<double> row(channels);
  std::vector<Transform> pose(joints);
  for (std::size_t f = 0; f < frames; ++f) {
    for (std::size_t c = 0; c < channels; ++c) row[c] = values[c].values[f];
    kinematics.pose(row, pose);
    for (std::size_t j = 0; j < joints; ++j) {
      const Vec3f p = pose[j].position.cast<float>();
      const Quatf q = pose[j].orientation.cast<float>();
      ASSERT_EQ(std::memcmp(&positions[f * joints + j], &p, sizeof p), 0) << f << " " << j;
      ASSERT_EQ(std::memcmp(&orientations[f * joints + j], &q, sizeof q), 0) << f << " " << j;
    }
  }
}

TEST(Kinematics, ManyFramesGiveTheBitsOfOneByOne) {
  const Hierarchy hierarchy = odd_hierarchy();
  const std::size_t channels = hierarchy.channels.size();
  std::mt19937 engine(3);
  Conventions conventions;
  conventions.unit.metres = 0.01;
  conventions.up = Direction::plus_z;
  conventions.forward = Direction::minus_y;
  for (const auto positions : {Positions::absolute, Positions::additive}) {
    const Kinematics kinematics(hierarchy, positions, *Conversion::make(conventions));
    for (std::size_t frames = 1; frames <= kAtOnce; ++frames) {
      for (const double reach : {1.0, 180.0, 1e5, 1e15}) {
        const auto value = [&] {
          // Some channels are zero in some frames.
          const double part = static_cast<double>(engine()) / 2147483648.0 - 1.0;
          return engine() % 4 == 0 ? 0.0 : reach * part;
        };
        expect_same_kinematics(kinematics, channels, frames, value, reach <= 1e5);
      }
      expect_same_kinematics(
          kinematics, channels, frames, [] { return 0.0; }, true);
    }
  }
}

TEST(Kinematics, TellsWhatAFloatCannotHold) {
  const Hierarchy hierarchy = odd_hierarchy();
  const Kinematics kinematics(hierarchy, Positions::absolute, {});
  struct alignas(64) Line {
    double values[kAtOnce] = {};
  };
  std::vector<Line> values(hierarchy.channels.size());
  std::vector<Vec3f> positions(kAtOnce * kinematics.joint_count());
  std::vector<Quatf> orientations(positions.size());
  std::vector<double> scratch;
  const auto sound = [&](std::size_t frames) {
    return kinematics.poses({values[0].values, values.size() * kAtOnce}, frames, scratch, positions,
                            orientations);
  };
  EXPECT_TRUE(sound(kAtOnce));
  values[1].values[kAtOnce - 1] = 1e39;
  EXPECT_FALSE(sound(kAtOnce));
}

// Whatever the instruction set, and in whichever of the frames that are done together.
TEST(Kinematics, TellsWhatIsBeyondSense) {
  const Hierarchy hierarchy = odd_hierarchy();
  const Kinematics kinematics(hierarchy, Positions::absolute, {});
  EXPECT_EQ(kinematics.farthest(), 1e4 * 3);  // the extent along z
  struct alignas(64) Line {
    double values[kAtOnce] = {};
  };
  std::vector<Vec3f> positions(kAtOnce * kinematics.joint_count());
  std::vector<Quatf> orientations(positions.size());
  std::vector<double> scratch;
  const auto near = [&](std::size_t channel, std::size_t frame, double value) {
    std::vector<Line> values(hierarchy.channels.size());
    values[channel].values[frame] = value;
    return kinematics.poses({values[0].values, values.size() * kAtOnce}, kAtOnce, scratch,
                            positions, orientations);
  };
  for (const Simd simd : {Simd::other, Simd::avx2, Simd::avx512}) {
    limit_simd(simd);
    for (std::size_t frame = 0; frame < kAtOnce; ++frame) {
      EXPECT_TRUE(near(3, frame, 999999.0)) << frame;
      EXPECT_FALSE(near(3, frame, 1000001.0)) << frame;
      EXPECT_FALSE(near(3, frame, -1e9)) << frame;
      EXPECT_TRUE(near(0, frame, 2.9e4)) << frame;
      EXPECT_FALSE(near(0, frame, -4e4)) << frame;
      EXPECT_TRUE(near(11, frame, 1e9)) << frame;  // a channel that moves nothing
    }
  }
}

}  // namespace
}  // namespace krok::bvh
