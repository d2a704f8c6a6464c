#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

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

// Unit vector from right to left, from hips and shoulders.
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

std::optional<double> stretch(Positions pose, const Landmarks& marks) {
  if (!marks.upright_known()) return std::nullopt;
  const auto trunk = direction_between(at(pose, marks.hips), at(pose, marks.head));
  const auto legs = direction_between(middle_of_feet(pose, marks), at(pose, marks.hips));
  if (!trunk || !legs) return std::nullopt;
  return trunk->dot(*legs);
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

std::optional<Heights> heights_along(const Evidence& evidence, Direction up) {
  const auto stature = stature_of(evidence);
  if (!stature || evidence.marks.hips < 0) return std::nullopt;
  const double height = stature->metres;
  const Vec3 vertical = direction_vector(up);
  std::vector<double> lows;
  std::vector<double> hips;
  for (std::size_t i = 0; i < evidence.sample_count; ++i) {
    const Positions sample = evidence.sample(i);
    double low = INFINITY;
    for (const Vec3& position : sample) low = std::min(low, position.dot(vertical));
    const double above = at(sample, evidence.marks.hips).dot(vertical) - low;
    if (!std::isfinite(low) || !std::isfinite(above)) continue;
    lows.push_back(low / height);
    hips.push_back(above / height);
  }
  if (lows.empty()) return std::nullopt;
  const auto ranked = [](std::vector<double>& values, double share) {
    const double place = share * static_cast<double>(values.size());
    const auto found = values.begin() + static_cast<std::ptrdiff_t>(place);
    std::nth_element(values.begin(), found, values.end());
    return *found;
  };
  const double spread = ranked(lows, 0.9) - ranked(lows, 0.1);
  return Heights{ranked(lows, 0.5), ranked(hips, 0.5), spread};
}

}  // namespace krok::actor
