// The twisted forearm, for which each method's failing or keeping of the volume has a closed form.
// Would fail if dual quaternions collapsed as linear blend does, or linear blend did not.

#include "skinned.h"

namespace krok::test {
namespace {

constexpr int kRings = 101;
constexpr int kSides = 64;
constexpr double kRadius = 0.04, kLength = 0.25;

// A closed tube from the elbow along +X to the wrist, whose weight goes over from the one to the
// other.
Model forearm() {
  Model model;
  model.skeleton.add("elbow", -1, {Vec3(0.3, 1.4, 0), Quat::Identity()});
  model.skeleton.add("wrist", 0, {Vec3(0.3 + kLength, 1.4, 0), Quat::Identity()});
  model.influences_per_vertex = 2;
  for (int ring = 0; ring < kRings; ++ring) {
    const double place = static_cast<double>(ring) / (kRings - 1);
    for (int side = 0; side < kSides; ++side) {
      const double angle = 2 * kPi * side / kSides;
      const Vec3 out(0, std::cos(angle), std::sin(angle));
      model.positions.push_back(
          (Vec3(0.3 + place * kLength, 1.4, 0) + kRadius * out).cast<float>());
      model.normals.push_back(out.cast<float>());
      const bool elbow_first = place <= 0.5;
      const auto weight = static_cast<float>(elbow_first ? 1 - place : place);
      for (const int joint : elbow_first ? std::array{0, 1} : std::array{1, 0}) {
        model.influence_joints.push_back(static_cast<std::uint16_t>(joint));
      }
      model.influence_weights.push_back(weight);
      model.influence_weights.push_back(1 - weight);
    }
  }
  return model;
}

std::vector<Transform> twisted(const Model& model, double angle) {
  auto pose = model.skeleton.reference;
  pose[1].orientation = from_rotation_vector(Vec3(angle, 0, 0));
  return pose;
}

// The area of a ring, by the shoelace formula, in units of the untwisted one.
double ring_area(const std::vector<Vec3f>& positions, int ring) {
  double area = 0;
  for (int side = 0; side < kSides; ++side) {
    const Vec3f& a = positions[static_cast<std::size_t>(ring * kSides + side)];
    const Vec3f& b = positions[static_cast<std::size_t>(ring * kSides + (side + 1) % kSides)];
    area += (double{a.y()} - 1.4) * b.z() - (double{b.y()} - 1.4) * a.z();
  }
  return std::abs(area) / (kSides * std::sin(2 * kPi / kSides) * kRadius * kRadius);
}

double radius(const Vec3f& position) {
  return std::hypot(double{position.y()} - 1.4, double{position.z()});
}

TEST(Twist, LinearBlendLosesTheRadius) {
  const Model model = forearm();
  for (const double angle : {0.5, 1.0, kPi / 2, 2.0, 3.0, kPi}) {
    const Skinned out = skinned(model, SkinMethod::linear, twisted(model, angle));
    for (int ring = 0; ring < kRings; ++ring) {
      const double w = static_cast<double>(ring) / (kRings - 1);
      // Two turns by 0 and `angle`, weights 1 - w and w; in the middle cos(angle / 2).
      const double expected =
          kRadius * std::sqrt(std::max(0.0, 1 - 2 * w * (1 - w) * (1 - std::cos(angle))));
      const auto v = static_cast<std::size_t>(ring * kSides);
      EXPECT_NEAR(radius(out.positions[v]), expected, 1e-6);
      if (2 * ring == kRings - 1) {
        EXPECT_NEAR(radius(out.positions[v]), kRadius * std::cos(angle / 2), 1e-6);
      }
    }
  }
}

TEST(Twist, LinearBlendLosesTheVolume) {
  const Model model = forearm();
  for (const double angle : {0.5, kPi / 2, kPi}) {
    const Skinned out = skinned(model, SkinMethod::linear, twisted(model, angle));
    double volume = 0;  // Simpson's rule, which is exact here
    for (int ring = 0; ring < kRings; ++ring) {
      const double factor = ring == 0 || ring == kRings - 1 ? 1 : ring % 2 == 1 ? 4 : 2;
      volume += factor * ring_area(out.positions, ring) / (3.0 * (kRings - 1));
    }
    // The integral of 1 - 2 w (1 - w) (1 - cos angle): at half a turn a third is left.
    EXPECT_NEAR(volume, 1 - (1 - std::cos(angle)) / 3, 1e-4) << angle;
  }
}

TEST(Twist, DualQuaternionsKeepTheRadius) {
  const Model model = forearm();
  for (const double angle : {0.5, 1.0, kPi / 2, 2.0, 3.0, 3.14}) {
    const Skinned out = skinned(model, SkinMethod::dual_quaternion, twisted(model, angle));
    for (std::size_t v = 0; v < model.positions.size(); ++v) {
      EXPECT_NEAR(radius(out.positions[v]), kRadius, 1e-6);
      EXPECT_NEAR(out.positions[v].x(), model.positions[v].x(), 1e-6);
    }
    for (int ring = 0; ring < kRings; ++ring) {
      EXPECT_NEAR(ring_area(out.positions, ring), 1, 1e-4);
    }
    // In the middle half the angle.
    const auto middle = static_cast<std::size_t>(kRings / 2 * kSides);
    const Vec3f expected(0.3f + kLength / 2,
                         static_cast<float>(1.4 + kRadius * std::cos(angle / 2)),
                         static_cast<float>(kRadius * std::sin(angle / 2)));
    EXPECT_LT((out.positions[middle] - expected).norm(), 1e-6f);
  }
}

}  // namespace
}  // namespace krok::test
