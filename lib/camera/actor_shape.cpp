#include "camera/actor_camera.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <numeric>

#include "core/index.h"
#include "motion/hips_root.h"
#include "motion/travel.h"

namespace krok {

namespace {

// Radii as fractions of the character's height: flesh around a joint, and what extends beyond the
// last joint of a head or hand without end sites.
constexpr double kFlesh = 0.06;
constexpr double kHeadBeyond = 0.14;
constexpr double kHandBeyond = 0.12;
constexpr double kMinHeight = 0.01;  // metres

bool is_bare_leaf(const Skeleton& skeleton, const std::vector<std::vector<int>>& children,
                  int joint) {
  return children[at(joint)].empty() && skeleton.end_sites[at(joint)] == 0;
}

double height_of(const Clip& clip) {
  double height = std::max(reference_height(clip.skeleton), reference_extent(clip.skeleton));
  if (height < kMinHeight) {
    Vec3f low = clip.positions[0], high = low;
    for (const Vec3f& position : clip.frame_positions(0)) {
      low = low.cwiseMin(position);
      high = high.cwiseMax(position);
    }
    height = static_cast<double>((high - low).maxCoeff());
  }
  return std::max(height, kMinHeight);
}

void mark(std::vector<std::uint8_t>& marks, const std::vector<std::uint8_t>& more,
          std::uint8_t value) {
  for (std::size_t j = 0; j < marks.size(); ++j) {
    if (more[j] != 0) marks[j] = value;
  }
}

Error unknown(const char* part, const char* role) {
  return Error("camera-part",
               fmt::format("no joint has the role {}, so the {} cannot be framed", role, part),
               "assign the joint roles with a map, or frame the full character");
}

// 1 for joints of the part.
Result<std::vector<std::uint8_t>> part_of(const Skeleton& skeleton, const RoleMap& roles,
                                          Framing framing, int joint) {
  std::vector<std::uint8_t> part(skeleton.names.size(), framing == Framing::full ? 1 : 0);
  if (framing == Framing::upper) {
    const int hips = roles.joint(Role::hips);
    if (hips < 0) return unknown("upper body", "hips");
    mark(part, subtree(skeleton, hips), 1);
    for (const Role role : {Role::left_upper_leg, Role::right_upper_leg}) {
      const int leg = roles.joint(role);
      if (leg >= 0) mark(part, subtree(skeleton, leg), 0);
    }
    part[at(hips)] = 1;
  } else if (framing == Framing::head) {
    const int head =
        roles.joint(Role::head) >= 0 ? roles.joint(Role::head) : roles.joint(Role::neck);
    if (head < 0) return unknown("head", "head or neck");
    mark(part, subtree(skeleton, head), 1);
  } else if (framing == Framing::joint) {
    for (int j = 0; j < skeleton.joint_count(); ++j) {
      part[at(j)] = j == joint || skeleton.parents[at(j)] == joint ? 1 : 0;
    }
    if (const int parent = skeleton.parents[at(joint)]; parent >= 0) part[at(parent)] = 1;
  }
  return part;
}

}  // namespace

Result<ActorShape> actor_shape(const Clip& clip, const RoleMap& roles, Framing framing, int joint) {
  const Skeleton& skeleton = clip.skeleton;
  if (skeleton.empty() || clip.frame_count() == 0) {
    return Error("camera-empty", "the motion has no frames");
  }
  const auto part = part_of(skeleton, roles, framing, joint);
  if (!part) return part.error();
  ActorShape shape;
  const auto children = skeleton.children();
  const double height = height_of(clip);
  for (int j = 0; j < skeleton.joint_count(); ++j) {
    const Role role = roles.roles[at(j)];
    const bool bare = is_bare_leaf(skeleton, children, j);
    double beyond = kFlesh;
    if (bare && role == Role::head) beyond = kHeadBeyond;
    if (bare && (role == Role::left_hand || role == Role::right_hand)) beyond = kHandBeyond;
    shape.radii.push_back(beyond * height);
    const bool counts = role != Role::root && role != Role::helper;
    if (counts) shape.body.push_back(j);
    if (counts && (*part)[at(j)] != 0) shape.shown.push_back(j);
  }
  if (shape.body.empty() || shape.shown.empty()) {
    shape.body.resize(skeleton.names.size());
    std::iota(shape.body.begin(), shape.body.end(), 0);
    shape.shown = shape.body;
  }
  shape.parents.assign(skeleton.names.size(), -1);
  std::vector<std::uint8_t> counted(skeleton.names.size(), 0);
  for (const int j : shape.body) counted[at(j)] = 1;
  for (const int j : shape.body) {
    const int parent = skeleton.parents[at(j)];
    if (parent >= 0 && counted[at(parent)] != 0) shape.parents[at(j)] = parent;
  }
  return shape;
}

void balls_of(const ActorShape& shape, std::span<const int> joints,
              std::span<const Vec3f> positions, std::vector<Ball>& balls) {
  balls.clear();
  for (const int j : joints) {
    balls.push_back({positions[at(j)].cast<double>(), shape.radii[at(j)]});
  }
}

double distance_to_body(const ActorShape& shape, std::span<const Vec3f> positions,
                        const Vec3& point) {
  double least = std::numeric_limits<double>::infinity();
  for (const int j : shape.body) {
    const int parent = shape.parents[at(j)];
    const Vec3 end = positions[at(j)].cast<double>();
    const Vec3 start = parent < 0 ? end : Vec3(positions[at(parent)].cast<double>());
    const Vec3 bone = end - start;
    const double squared = bone.squaredNorm();
    const double along =
        squared > 0 ? std::clamp((point - start).dot(bone) / squared, 0.0, 1.0) : 0.0;
    const double thickness =
        parent < 0 ? shape.radii[at(j)] : std::min(shape.radii[at(j)], shape.radii[at(parent)]);
    least = std::min(least, (point - start - along * bone).norm() - thickness);
  }
  return least;
}

}  // namespace krok
