#include "ragdoll/bodies.h"

#include <algorithm>
#include <cmath>

#include "core/index.h"
#include "math/quaternion.h"

namespace krok::ragdoll {

namespace {

constexpr double kShortestBone = 0.03;     // shares of the extent
constexpr double kShortestOfMedian = 0.4;  // of the bones' lengths: a snake has many short ones
constexpr double kThinnest = 0.012, kThickest = 0.08;
constexpr double kSlenderness = 0.2;  // radius over length
constexpr double kSwing = 50 * kRadiansPerDegree, kTwist = 30 * kRadiansPerDegree;

class BoneFinder {
 public:
  explicit BoneFinder(const Skeleton& skeleton) : skeleton_(skeleton) {
    for (int j = 0; j < skeleton.joint_count(); ++j) {
      children_.emplace_back();
      const int parent = skeleton.parents[at(j)];
      if (parent >= 0) children_[at(parent)].push_back(j);
    }
  }

  // From the joint to the end of its bone.
  Vec3 bone(int joint) const;

  // Of bones longer than `least`; 0 if there is none.
  double median_length(double least) const;

 private:
  Vec3 place(int joint) const { return skeleton_.reference[at(joint)].position; }

  const Skeleton& skeleton_;
  std::vector<std::vector<int>> children_;
};

Vec3 BoneFinder::bone(int joint) const {
  if (children_[at(joint)].empty()) {
    const int parent = skeleton_.parents[at(joint)];
    return parent < 0 ? Vec3(Vec3::Zero()) : Vec3(0.5 * (place(joint) - place(parent)));
  }
  Vec3 middle = Vec3::Zero(), farthest = Vec3::Zero();
  double count = 0;
  for (const int child : children_[at(joint)]) {
    const Vec3 to = place(child) - place(joint);
    middle += to;
    ++count;
    if (to.norm() > farthest.norm()) farthest = to;
  }
  middle /= count;
  return middle.norm() < 0.5 * farthest.norm() ? farthest : middle;
}

double BoneFinder::median_length(double least) const {
  std::vector<double> lengths;
  for (int j = 0; j < skeleton_.joint_count(); ++j) {
    const double length = bone(j).norm();
    if (skeleton_.end_sites[at(j)] == 0 && length > least) lengths.push_back(length);
  }
  if (lengths.empty()) return 0;
  const auto middle = lengths.begin() + static_cast<std::ptrdiff_t>(lengths.size() / 2);
  std::nth_element(lengths.begin(), middle, lengths.end());
  return *middle;
}

// `joint`, or what is above it and carries half of the skeleton's bones or more by their length: in
// some rigs hips hang on the trunk.
int joint_with_half(const Skeleton& skeleton, int joint) {
  std::vector<double> below(skeleton.names.size(), 0.0);  // metres of bones
  for (std::size_t j = below.size(); j-- > 1;) {
    const std::size_t parent = at(skeleton.parents[j]);
    const double bone =
        (skeleton.reference[j].position - skeleton.reference[parent].position).norm();
    below[parent] += below[j] + bone;
  }
  while (joint > 0 && below[at(joint)] < 0.5 * below.front()) joint = skeleton.parents[at(joint)];
  return std::max(joint, 0);
}

}  // namespace

double extent(const Skeleton& skeleton) {
  if (skeleton.reference.empty()) return 0;
  Vec3 low = skeleton.reference.front().position, high = low;
  for (const Transform& joint : skeleton.reference) {
    low = low.cwiseMin(joint.position);
    high = high.cwiseMax(joint.position);
  }
  return (high - low).maxCoeff();
}

std::vector<Body> bone_bodies(const Skeleton& skeleton, int root) {
  root = joint_with_half(skeleton, root);
  const double size = extent(skeleton);
  std::vector<Body> bodies;
  if (!(size > 0) || !std::isfinite(size)) return bodies;
  const BoneFinder finder(skeleton);
  const double shortest =
      std::min(kShortestBone * size, kShortestOfMedian * finder.median_length(1e-6 * size));
  std::vector<int> carrier(skeleton.names.size(), -1);
  for (int j = 0; j < skeleton.joint_count(); ++j) {
    const int above = skeleton.parents[at(j)] < 0 ? -1 : carrier[at(skeleton.parents[at(j)])];
    carrier[at(j)] = above;
    if (j != root && above < 0) continue;
    Vec3 bone = skeleton.end_sites[at(j)] != 0 ? Vec3(Vec3::Zero()) : finder.bone(j);
    if (bone.norm() < shortest) {
      // The root carries all others, however short its bone.
      if (j != root) continue;
      if (bone.norm() < 1e-6 * size) bone = Vec3::UnitY();
      bone *= std::max(shortest, 0.01 * size) / bone.norm();
    }
    const double length = bone.norm();
    Body body;
    body.name = skeleton.names[at(j)];
    body.joint = j;
    body.parent = above;
    body.shape.kind = Shape::Kind::capsule;
    body.shape.radius = std::min(
        std::clamp(kSlenderness * length, kThinnest * size, kThickest * size), 0.45 * length);
    body.shape.half_length = 0.5 * length - body.shape.radius;
    const Transform to_world{skeleton.reference[at(j)].position + 0.5 * bone,
                             shortest_arc(Vec3::UnitY(), bone)};
    body.to_joint = skeleton.reference[at(j)].inverse() * to_world;
    body.to_joint.orientation.normalize();
    carrier[at(j)] = static_cast<int>(bodies.size());
    bodies.push_back(std::move(body));
  }
  return bodies;
}

ik::Limits cone_limits(const Skeleton& skeleton, const std::vector<Body>& bodies) {
  ik::Limits limits(skeleton.names.size());
  for (const Body& body : bodies) {
    const int parent = skeleton.parents[at(body.joint)];
    if (parent < 0) continue;
    ik::JointLimit& limit = limits[at(body.joint)];
    limit.kind = ik::JointLimit::Kind::cone;
    limit.zero = (skeleton.reference[at(parent)].orientation.conjugate() *
                  skeleton.reference[at(body.joint)].orientation)
                     .normalized();
    limit.axis = (body.to_joint.orientation * Vec3(Vec3::UnitY())).normalized();
    limit.swing_axis = (body.to_joint.orientation * Vec3(Vec3::UnitX())).normalized();
    limit.min_twist = -kTwist;
    limit.max_twist = kTwist;
    limit.min_swing.fill(-kSwing);
    limit.max_swing.fill(kSwing);
  }
  return limits;
}

}  // namespace krok::ragdoll
