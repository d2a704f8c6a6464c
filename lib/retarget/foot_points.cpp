#include "retarget/foot_points.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <set>

#include "contacts/legs.h"
#include "core/index.h"
#include "math/quaternion.h"
#include "retarget/actor_view_internal.h"
#include "retarget/limb_ends.h"
#include "retarget/moved_limb.h"
#include "retarget/pose_alignment.h"

namespace krok::retarget {

namespace {

constexpr int kPitches = 6;  // steps upwards and downwards
constexpr double kPitchStep = 15 * kRadiansPerDegree;

// The joint that a vertex follows by more than half, or -1; influences are in decreasing order.
int joint_of_vertex(const Model& model, std::size_t vertex) {
  const std::size_t first = vertex * static_cast<std::size_t>(model.influences_per_vertex);
  return model.influence_weights[first] > 0.5F ? model.influence_joints[first] : -1;
}

// Towards the left of a foot in the reference pose.
Vec3 left_of_foot(const Skeleton& skeleton, const RoleMap& roles, Role foot) {
  const auto place = [&](int joint) { return skeleton.reference[at(joint)].position; };
  const int front = foot_front(skeleton, roles, foot);
  const Vec3 ahead =
      front < 0 ? Vec3::UnitZ() : flat(place(front) - place(roles.joint(foot))).stableNormalized();
  return kUp.cross(ahead);
}

}  // namespace

std::vector<BodyPoint> points_of_feet(const Model& model, const Skeleton& skeleton,
                                      const RoleMap& roles) {
  const std::vector<int> ends =
      carrying_ends(skeleton, skeleton.joint_count() - model.skeleton.joint_count());
  std::map<int, std::vector<Vec3>> places;  // of vertices, reference pose
  for (const Role role : {Role::left_foot, Role::right_foot}) {
    if (roles.joint(role) < 0) return {};
    for (const int joint : joints_below(skeleton, roles.joint(role))) places[joint];
  }
  for (std::size_t v = 0; v < model.positions.size(); ++v) {
    int joint = joint_of_vertex(model, v);
    if (joint >= 0 && ends[at(joint)] >= 0) joint = ends[at(joint)];
    const auto found = places.find(joint);
    if (found != places.end()) found->second.push_back(model.positions[v].cast<double>());
  }
  std::vector<BodyPoint> points;
  for (const Role role : {Role::left_foot, Role::right_foot}) {
    const Vec3 left = left_of_foot(skeleton, roles, role);
    for (const int joint : joints_below(skeleton, roles.joint(role))) {
      const std::vector<Vec3>& vertices = places[joint];
      if (vertices.empty()) continue;
      const Vec3 middle = std::accumulate(vertices.begin(), vertices.end(), Vec3(Vec3::Zero())) /
                          static_cast<double>(vertices.size());
      std::set<std::size_t> lowest;
      for (int pitch = -kPitches; pitch <= kPitches; ++pitch) {
        const Vec3 up = from_rotation_vector(pitch * kPitchStep * left) * kUp;
        const auto height = [&](const Vec3& vertex) { return up.dot(vertex); };
        lowest.insert(static_cast<std::size_t>(std::ranges::min_element(vertices, {}, height) -
                                               vertices.begin()));
      }
      const Transform to_joint = skeleton.reference[at(joint)].inverse();
      for (const std::size_t vertex : lowest) {
        const Vec3 aside = left * left.dot(vertices[vertex] - middle);
        points.push_back({joint, to_joint * Vec3(vertices[vertex] - aside)});
      }
    }
  }
  return points;
}

std::vector<BodyPoint> estimated_tips(const krok::Feet& feet) {
  std::vector<BodyPoint> points;
  for (const auto& side : feet.points) {
    const SolePoint* tip = point_of(side, FootPart::tip);
    if (tip != nullptr && tip->estimated) points.push_back({tip->joint, tip->offset});
  }
  return points;
}

}  // namespace krok::retarget
