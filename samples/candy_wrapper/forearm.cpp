#include "samples/candy_wrapper/forearm.h"

#include <algorithm>
#include <cmath>

#include "math/quaternion.h"

namespace krok::samples {

namespace {

constexpr double kUpperEnd = -0.06, kHandEnd = kForearmLength + 0.16;
const Vec3 kElbow(0, 1, 0);

// Half-axes of the section at a position along the arm.
struct Section {
  double x, height, width;
};

Section section(double x) {
  if (x <= 0) {
    const double left = std::sqrt(std::max(0.0, 1 - (x / kUpperEnd) * (x / kUpperEnd)));
    return {x, kForearmHeight * left, kForearmWidth * left};
  }
  if (x <= kForearmLength) return {x, kForearmHeight, kForearmWidth};
  // The palm is flatter and wider.
  const double t = (x - kForearmLength) / (kHandEnd - kForearmLength);
  const double palm = std::min(1.0, 2 * t);
  const double over = palm * palm * (3 - 2 * palm);
  const double left = std::sqrt(std::max(0.0, 1 - std::pow(t, 4)));
  return {x, (kForearmHeight + over * (0.015 - kForearmHeight)) * left,
          (kForearmWidth + over * (0.055 - kForearmWidth)) * left};
}

// Sections along the arm, dense where the surface curves or twists; both ends are points.
std::vector<Section> rings() {
  std::vector<Section> result;
  constexpr int kCap = 16, kStretch = 120, kHand = 40;
  for (int i = 1; i < kCap; ++i) {
    result.push_back(section(kUpperEnd * std::cos(0.5 * kPi * i / kCap)));
  }
  for (int i = 0; i <= kStretch; ++i) result.push_back(section(kForearmLength * i / kStretch));
  for (int i = 1; i < kHand; ++i) {
    const double along = std::sin(0.5 * kPi * i / kHand);
    result.push_back(section(kForearmLength + (kHandEnd - kForearmLength) * along));
  }
  return result;
}

void add_vertex(const Vec3& position, Model& model) {
  const double wrist = std::clamp(position.x() / kForearmLength, 0.0, 1.0);
  const auto weight = static_cast<float>(std::max(wrist, 1 - wrist));
  const std::uint16_t first = wrist > 0.5 ? 1 : 0;
  model.positions.push_back((kElbow + position).cast<float>());
  const bool second = weight < 1;
  model.influence_joints.push_back(first);
  model.influence_joints.push_back(second ? static_cast<std::uint16_t>(1 - first) : 0);
  model.influence_weights.push_back(weight);
  model.influence_weights.push_back(1 - weight);
}

// Area-weighted vertex normals.
void add_normals(Model& model) {
  std::vector<Vec3> sums(model.positions.size(), Vec3::Zero());
  const auto at = [&](std::uint32_t v) -> Vec3 { return model.positions[v].cast<double>(); };
  for (const auto& [a, b, c] : model.triangles) {
    const Vec3 normal = (at(b) - at(a)).cross(at(c) - at(a));
    for (const std::uint32_t v : {a, b, c}) sums[v] += normal;
  }
  for (const Vec3& sum : sums) model.normals.push_back(sum.normalized().cast<float>());
}

}  // namespace

Model make_forearm() {
  Model model;
  model.skeleton.add("elbow", -1, {kElbow, Quat::Identity()});
  model.skeleton.add("wrist", 0, {kElbow + Vec3(kForearmLength, 0, 0), Quat::Identity()});
  model.influences_per_vertex = 2;

  const auto sections = rings();
  constexpr std::uint32_t kSides = kForearmSides;
  for (const Section& ring : sections) {
    for (std::uint32_t k = 0; k < kSides; ++k) {
      const double angle = 2 * kPi * k / kSides;
      add_vertex({ring.x, ring.height * std::cos(angle), ring.width * std::sin(angle)}, model);
    }
  }
  const auto upper = static_cast<std::uint32_t>(model.positions.size()), hand = upper + 1;
  add_vertex({kUpperEnd, 0, 0}, model);
  add_vertex({kHandEnd, 0, 0}, model);

  const auto last = static_cast<std::uint32_t>(sections.size() - 1);
  const auto at = [&](std::uint32_t i, std::uint32_t k) { return i * kSides + k % kSides; };
  for (std::uint32_t k = 0; k < kSides; ++k) {
    model.triangles.push_back({upper, at(0, k + 1), at(0, k)});
    for (std::uint32_t i = 0; i < last; ++i) {
      model.triangles.push_back({at(i, k), at(i, k + 1), at(i + 1, k)});
      model.triangles.push_back({at(i + 1, k), at(i, k + 1), at(i + 1, k + 1)});
    }
    model.triangles.push_back({at(last, k), at(last, k + 1), hand});
  }
  model.parts.push_back({"forearm", "skin", 0, static_cast<std::uint32_t>(model.triangles.size())});
  add_normals(model);
  return model;
}

Clip make_twist() {
  Clip clip;
  clip.skeleton = make_forearm().skeleton;
  clip.rate = 60;
  clip.resize(181);
  for (int degree = 0; degree <= 180; ++degree) {
    auto pose = clip.skeleton.reference;
    pose[1].orientation = from_rotation_vector(Vec3(degree * kRadiansPerDegree, 0, 0));
    clip.set_pose(degree, pose);
  }
  return clip;
}

}  // namespace krok::samples
