#include "tools/shared/bone_actor.h"

#include <algorithm>

#include "roles/roles.h"

namespace krok::cli {

namespace {

constexpr double kRadius = 0.011;     // of the actor's size
constexpr float kThinning = 0.22F;    // max radius, of the bone's length
constexpr float kJointToBone = 1.0F;  // radius at the start of a bone ...
constexpr float kTip = 0.6F;          // ... and at its end, of its thickness

BodySide side_of(Role role) {
  if (role >= Role::left_collar && role <= Role::left_fingers) return BodySide::left;
  if (role >= Role::left_upper_leg && role <= Role::left_toes) return BodySide::left;
  if (role >= Role::right_collar && role <= Role::right_fingers) return BodySide::right;
  if (role >= Role::right_upper_leg && role <= Role::right_toes) return BodySide::right;
  return BodySide::middle;
}

// The side of the body of each joint, from joint roles; middle if unknown.
std::vector<BodySide> body_sides(const Skeleton& skeleton) {
  const RoleMap roles = find_roles(skeleton);
  std::vector<BodySide> sides;
  for (std::size_t j = 0; j < skeleton.names.size(); ++j) {
    BodySide side = side_of(roles.roles[j]);
    // Descendants of a limb are on its side.
    const int parent = skeleton.parents[j];
    if (side == BodySide::middle && parent >= 0) side = sides[static_cast<std::size_t>(parent)];
    sides.push_back(side);
  }
  return sides;
}

}  // namespace

render::Colour side_colour(BodySide side) {
  switch (side) {
    case BodySide::left:
      return render::colour(0x2F6FD0);
    case BodySide::right:
      return render::colour(0xE0761E);
    default:
      return render::colour(0x77828E);
  }
}

double bone_radius(double extent) {
  return extent > 0 ? kRadius * extent : 0.01;
}

BoneStyle bone_style(const Skeleton& skeleton) {
  BoneStyle style;
  style.parents = skeleton.parents;
  style.colours.assign(skeleton.parents.size(), side_colour(BodySide::middle));
  if (check(skeleton)) {
    std::ranges::transform(body_sides(skeleton), style.colours.begin(), side_colour);
    const int hips = find_roles(skeleton).joint(Role::hips);
    for (int joint = hips; joint >= 0;) {
      const int above = skeleton.parents[static_cast<std::size_t>(joint)];
      style.parents[static_cast<std::size_t>(joint)] = joint == hips ? -1 : BoneStyle::kLeftOut;
      joint = above;
    }
  }
  style.radius = bone_radius(reference_extent(skeleton));
  return style;
}

render::Actor bone_actor(const BoneStyle& style, std::span<const Vec3f> positions) {
  render::Actor actor;
  const auto radius = static_cast<float>(style.radius);
  // A joint is as thick as its thickest bone.
  std::vector<float> thickness(positions.size(), 0.0F);
  std::vector<int> meeting(positions.size(), 0);
  for (std::size_t j = 0; j < positions.size(); ++j) {
    if (style.parents[j] < 0) continue;
    const auto parent = static_cast<std::size_t>(style.parents[j]);
    const float length = (positions[j] - positions[parent]).norm();
    const float thick = std::min(radius, kThinning * length);
    const render::Colour colour = style.colours[j];
    actor.bones.push_back({positions[parent], positions[j], kJointToBone * thick, kTip * thick,
                           style.blended ? style.colours[parent] : colour, colour});
    for (const std::size_t end : {j, parent}) {
      thickness[end] = std::max(thickness[end], thick);
      ++meeting[end];
    }
  }
  for (std::size_t j = 0; j < positions.size(); ++j) {
    if (style.parents[j] == BoneStyle::kLeftOut) continue;
    const float thick = meeting[j] > 0 ? thickness[j] : radius;
    actor.bones.push_back(
        {positions[j], positions[j], thick, thick, style.colours[j], style.colours[j]});
  }
  return actor;
}

}  // namespace krok::cli
