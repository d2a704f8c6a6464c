#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <string>

#include "capture/actor_internal.h"

namespace krok::actor {

namespace {

int end_below(const Skeleton& skeleton, int joint) {
  for (std::size_t j = 0; joint >= 0 && j < skeleton.parents.size(); ++j) {
    if (skeleton.parents[j] == joint && skeleton.end_sites[j] != 0) return static_cast<int>(j);
  }
  return -1;
}

Vec3 middle_of_feet(Positions pose, const Landmarks& marks) {
  return 0.5 * (at(pose, marks.left_foot) + at(pose, marks.right_foot));
}

// The up axis of an upright pose, from trunk and legs; empty if the body is bent at the hips or not
// along one axis.
std::optional<NearestAxis> standing_axis(Positions pose, const Landmarks& marks) {
  if (!marks.upright_known()) return std::nullopt;
  const auto trunk = direction_between(at(pose, marks.hips), at(pose, marks.head));
  const auto legs = direction_between(middle_of_feet(pose, marks), at(pose, marks.hips));
  if (!trunk || !legs || trunk->dot(*legs) < 0.7) return std::nullopt;
  const NearestAxis axis = nearest_axis(*trunk + *legs);
  if (axis.cosine < 0.85) return std::nullopt;
  return axis;
}

}  // namespace

std::optional<Vec3> side_axis(Positions pose, const Landmarks& marks) {
  Vec3 sum = Vec3::Zero();
  const auto add = [&](int right, int left) {
    if (right < 0 || left < 0) return;
    if (const auto side = direction_between(at(pose, right), at(pose, left))) sum += *side;
  };
  add(marks.right_leg, marks.left_leg);
  add(marks.right_arm, marks.left_arm);
  return direction_between(Vec3::Zero(), sum);
}

NearestAxis nearest_axis(const Vec3& v) {
  int axis = 0;
  const double largest = v.cwiseAbs().maxCoeff(&axis);
  const double length = v.stableNorm();
  if (!(length > 0) || !std::isfinite(length)) return {};
  return {static_cast<Direction>(2 * axis + (v[axis] < 0 ? 1 : 0)), largest / length};
}

Direction opposite(Direction d) {
  return static_cast<Direction>(static_cast<int>(d) ^ 1);
}

bool on_one_axis(Direction a, Direction b) {
  return static_cast<int>(a) / 2 == static_cast<int>(b) / 2;
}

std::string signed_name(Direction d) {
  const std::string_view name = direction_name(d);
  return name.starts_with('-') ? std::string(name) : "+" + std::string(name);
}

std::optional<Vec3> direction_between(const Vec3& from, const Vec3& to) {
  const Vec3 v = to - from;
  const double length = v.stableNorm();
  if (!(length > 0) || !std::isfinite(length)) return std::nullopt;
  return v / length;
}

Landmarks::Landmarks(const Skeleton& skeleton, const RoleMap& roles)
    : hips(roles.joint(Role::hips)),
      head(roles.joint(Role::head)),
      left_foot(roles.joint(Role::left_foot)),
      right_foot(roles.joint(Role::right_foot)),
      left_toes(roles.joint(Role::left_toes)),
      right_toes(roles.joint(Role::right_toes)),
      left_leg(roles.joint(Role::left_upper_leg)),
      right_leg(roles.joint(Role::right_upper_leg)),
      left_arm(roles.joint(Role::left_upper_arm)),
      right_arm(roles.joint(Role::right_upper_arm)) {
  if (head < 0) head = roles.joint(Role::neck);
  if (left_toes < 0) left_toes = end_below(skeleton, left_foot);
  if (right_toes < 0) right_toes = end_below(skeleton, right_foot);
}

std::optional<Vec3> body_axis(Positions pose, const Landmarks& marks) {
  const Vec3 low = marks.feet_known() ? middle_of_feet(pose, marks) : at(pose, marks.hips);
  return direction_between(low, at(pose, marks.head));
}

std::optional<Vec3> facing(Positions pose, const Landmarks& marks, Direction up) {
  const auto side = side_axis(pose, marks);
  if (!side) return std::nullopt;
  const Vec3 forward = side->cross(direction_vector(up));
  if (!(forward.norm() > 0.2)) return std::nullopt;  // the body lies on its side
  return forward.normalized();
}

std::optional<Vec3> toes_direction(Positions pose, const Landmarks& marks, Direction up) {
  Vec3 sum = Vec3::Zero();
  const Vec3 vertical = direction_vector(up);
  const auto add = [&](int foot, int toes) {
    if (foot < 0 || toes < 0) return;
    const auto along = direction_between(at(pose, foot), at(pose, toes));
    if (along) sum += *along - along->dot(vertical) * vertical;
  };
  add(marks.left_foot, marks.left_toes);
  add(marks.right_foot, marks.right_toes);
  if (!sum.allFinite() || sum.norm() < 0.2) return std::nullopt;
  return sum.normalized();
}

Evidence::Evidence(const Skeleton& s, const RoleMap& r, std::span<const Vec3> sample_positions)
    : skeleton(s), roles(r), marks(s, r), samples(sample_positions) {
  for (const Transform& transform : s.reference) reference.push_back(transform.position);
  if (!reference.empty()) sample_count = samples.size() / reference.size();
  reference_stands = standing_axis(reference, marks);
}

std::optional<Stature> stature_of(const Evidence& evidence) {
  const auto stature = krok::stature_of(evidence.skeleton, evidence.roles, evidence.reference);
  if (stature || evidence.sample_count == 0) return stature;
  return krok::stature_of(evidence.skeleton, evidence.roles, evidence.sample(0));
}

std::optional<std::array<Heights, 6>> heights_of(const Evidence& evidence) {
  const auto stature = stature_of(evidence);
  const int hips = evidence.marks.hips;
  if (!stature || hips < 0) return std::nullopt;
  // What carries the hips may be a point of the world that never moves.
  const std::vector<int>& parents = evidence.skeleton.parents;
  std::vector<char> carried(parents.size());
  for (std::size_t j = 0; j < parents.size(); ++j) {
    carried[j] = static_cast<int>(j) == hips ||
                 (parents[j] >= 0 && carried[static_cast<std::size_t>(parents[j])] != 0);
  }
  std::array<std::vector<double>, 6> lows, aboves;
  for (std::size_t i = 0; i < evidence.sample_count; ++i) {
    const Positions sample = evidence.sample(i);
    Eigen::AlignedBox3d box;
    for (std::size_t j = 0; j < carried.size(); ++j) {
      if (carried[j] != 0) box.extend(sample[j]);
    }
    if (!box.min().allFinite() || !box.max().allFinite()) continue;
    for (std::size_t d = 0; d < 6; ++d) {
      const auto axis = static_cast<Eigen::Index>(d / 2);
      const double low = d % 2 == 0 ? box.min()[axis] : -box.max()[axis];
      const double hip = (d % 2 == 0 ? 1.0 : -1.0) * at(sample, hips)[axis];
      lows[d].push_back(low / stature->metres);
      aboves[d].push_back((hip - low) / stature->metres);
    }
  }
  if (lows[0].empty()) return std::nullopt;
  const auto ranked = [](std::vector<double>& values, double share) {
    const double place = share * static_cast<double>(values.size());
    const auto found = values.begin() + static_cast<std::ptrdiff_t>(place);
    std::nth_element(values.begin(), found, values.end());
    return *found;
  };
  std::array<Heights, 6> heights;
  for (std::size_t d = 0; d < 6; ++d) {
    const double spread = ranked(lows[d], 0.9) - ranked(lows[d], 0.1);
    heights[d] = {ranked(lows[d], 0.5), ranked(aboves[d], 0.5), spread};
  }
  return heights;
}

}  // namespace krok::actor
