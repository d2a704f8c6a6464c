#include "skin/bind.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <limits>
#include <unordered_map>
#include <vector>

#include "core/index.h"
#include "core/numbers.h"
#include "math/quaternion.h"
#include "scene/mesh_volume.h"

namespace krok {

namespace {

Error missing_joints(const std::vector<std::string>& names, const std::string& suggestion) {
  constexpr std::size_t kShown = 5;
  std::string list;
  for (std::size_t i = 0; i < names.size() && i < kShown; ++i) {
    list += (i > 0 ? ", " : "") + names[i];
  }
  if (names.size() > kShown) list += fmt::format(" and {} more", names.size() - kShown);
  return Error("skin-joint-missing",
               fmt::format("the motion has no joint {}, which the model needs", list), suggestion);
}

Diagnostic warning(std::string code, std::string joint, std::string message, std::string hint) {
  Diagnostic result = make_warning(std::move(code), std::move(message), std::move(hint));
  result.joint = std::move(joint);
  return result;
}

constexpr double kPlaceTolerance = 1e-3;  // metres

}  // namespace

Result<Model> bind_to(Model model, const Skeleton& skeleton) {
  normalize_influences(model);

  std::unordered_map<std::string_view, int> motion_joints;
  for (int j = 0; j < skeleton.joint_count(); ++j) motion_joints.emplace(skeleton.names[j], j);
  std::vector<int> to_motion(model.skeleton.names.size(), -1);
  for (std::size_t j = 0; j < to_motion.size(); ++j) {
    const auto found = motion_joints.find(model.skeleton.names[j]);
    if (found != motion_joints.end()) to_motion[j] = found->second;
  }

  std::vector<char> used(to_motion.size(), 0);
  for (std::size_t k = 0; k < model.influence_weights.size(); ++k) {
    if (model.influence_weights[k] > 0) used[model.influence_joints[k]] = 1;
  }
  std::vector<std::string> missing;
  for (std::size_t j = 0; j < to_motion.size(); ++j) {
    if (used[j] != 0 && to_motion[j] < 0) missing.push_back(model.skeleton.names[j]);
  }
  if (!missing.empty()) {
    return missing_joints(missing,
                          fmt::format("the motion's joints are {}, ...; the model and the "
                                      "motion must come from the same skeleton; krok-skin "
                                      "--retarget, or krok-retarget, moves motions to the model's",
                                      skeleton.empty() ? "none" : skeleton.names[0]));
  }

  Skeleton bound = skeleton;
  std::vector<int> to_model(bound.names.size(), -1);
  for (std::size_t j = 0; j < to_motion.size(); ++j) {
    if (to_motion[j] >= 0) to_model[to_motion[j]] = static_cast<int>(j);
  }
  for (int j = 0; j < bound.joint_count(); ++j) {
    if (to_model[j] >= 0) {
      bound.reference[j] = model.skeleton.reference[to_model[j]];
    } else if (bound.parents[j] != Skeleton::kNoParent) {
      bound.reference[j] = bound.reference[bound.parents[j]] * skeleton.reference_local(j);
    }
  }
  for (std::size_t k = 0; k < model.influence_joints.size(); ++k) {
    const int joint = model.influence_weights[k] > 0 ? to_motion[model.influence_joints[k]] : 0;
    model.influence_joints[k] = static_cast<std::uint16_t>(joint);
  }
  model.skeleton = std::move(bound);
  return model;
}

namespace {

// Joints whose offset from their parent is not that of the model, in the reference pose and the
// frames that were added.
class OffsetDifferences {
 public:
  OffsetDifferences(const Skeleton& model, const Skeleton& motion)
      : model_(model), lengths_(model.names.size(), {std::numeric_limits<float>::infinity(), 0}) {
    for (int j = 0; j < model.joint_count(); ++j) {
      nearest_.push_back(motion.reference_local(j).position);
    }
  }

  // Whether further frames matter: the offsets of most joints are constant, and the reference pose
  // suffices.
  bool any() const {
    for (int j = 0; j < model_.joint_count(); ++j) {
      if (differs(j)) return true;
    }
    return false;
  }

  void add(const Clip& motion) {
    for (int j = 0; j < model_.joint_count(); ++j) {
      const int parent = model_.parents[at(j)];
      if (parent < 0) continue;
      for (int f = 0; is_at_root(j) && f < motion.frame_count(); ++f) {
        const auto places = motion.frame_positions(f);
        const float length = (places[at(j)] - places[at(parent)]).norm();
        lengths_[at(j)] = {std::min(lengths_[at(j)].first, length),
                           std::max(lengths_[at(j)].second, length)};
      }
      for (int f = 0; differs(j) && f < motion.frame_count(); ++f) {
        const auto places = motion.frame_positions(f);
        const Quat orientation =
            motion.frame_orientations(f)[at(parent)].cast<double>().normalized();
        const Vec3 place =
            orientation.conjugate() * (places[at(j)] - places[at(parent)]).cast<double>();
        const Vec3 wanted = model_.reference_local(j).position;
        if ((place - wanted).norm() < (nearest_[at(j)] - wanted).norm()) nearest_[at(j)] = place;
      }
    }
  }

  Diagnostics result() const;

 private:
  // The position of the root does not distort a mesh.
  bool differs(int joint) const {
    if (model_.parents[at(joint)] == Skeleton::kNoParent) return false;
    return (nearest_[at(joint)] - model_.reference_local(joint).position).norm() > kPlaceTolerance;
  }

  bool is_at_root(int joint) const {
    const int parent = model_.parents[at(joint)];
    return parent >= 0 && model_.parents[at(parent)] < 0;
  }

  // Whether a joint at the root moves away from it, as hips do below a root at the origin.
  bool leaves_root(int joint) const {
    constexpr float kFar = 0.1F;  // metres
    return is_at_root(joint) && lengths_[at(joint)].second - lengths_[at(joint)].first > kFar;
  }

  const Skeleton& model_;
  std::vector<Vec3> nearest_;                     // [joints], to the model's
  std::vector<std::pair<float, float>> lengths_;  // [joints], of those at the root
};

Diagnostics OffsetDifferences::result() const {
  double largest_length = 0, largest_turn = 0;
  int length_joint = 0, turn_joint = 0;
  for (int j = 0; j < model_.joint_count(); ++j) {
    if (!differs(j) || leaves_root(j)) continue;
    const Vec3 wanted = model_.reference_local(j).position;
    const double length = std::abs(wanted.norm() - nearest_[at(j)].norm());
    const double turn = (wanted - nearest_[at(j)]).norm();
    if (length > largest_length) {
      largest_length = length;
      length_joint = j;
    }
    if (length <= kPlaceTolerance && turn > largest_turn) {
      largest_turn = turn;
      turn_joint = j;
    }
  }
  const std::string hint =
      "build the model for this motion's skeleton; arrays take one from krok-import --skeleton "
      "FIRST.anim, and --retarget brings a person's motion onto the model's";
  Diagnostics result;
  if (largest_length > kPlaceTolerance) {
    const std::string& name = model_.names[length_joint];
    result.push_back(warning("skin-proportions", name,
                             fmt::format("the bone to {} is {} mm longer or shorter in the motion "
                                         "than in the model, so the mesh is stretched",
                                         name, readable(largest_length * 1e3, 3)),
                             hint));
  }
  if (largest_turn > kPlaceTolerance) {
    const std::string& name = model_.names[turn_joint];
    result.push_back(warning("skin-reference", name,
                             fmt::format("the bone to {} points in different directions in the "
                                         "motion and in the model, so the mesh is bent",
                                         name),
                             hint));
  }
  return result;
}

}  // namespace

Diagnostics reference_differences(const Skeleton& model, const Clip& motion) {
  OffsetDifferences differences(model, motion.skeleton);
  differences.add(motion);
  return differences.result();
}

Result<Diagnostics> reference_differences(const Skeleton& model, const FrameSource& motion,
                                          int jobs) {
  OffsetDifferences differences(model, motion.skeleton);
  if (!differences.any()) return Diagnostics();
  Status status = for_each_block(motion, jobs, [&](int, const Clip& block) {
    differences.add(block);
    return Status();
  });
  return status ? Result(differences.result()) : status.error();
}

namespace {

constexpr double kInside = 0.25;      // of the winding number
constexpr double kShortBone = 0.02;   // of the extent
constexpr double kSuspicious = 0.05;  // of the length of all bones
constexpr double kMost = 0.75;

struct Surface {
  std::vector<Vec3> positions;
  const std::vector<std::array<std::uint32_t, 3>>& triangles;

  double winding_number(const Vec3& at) const {
    double sum = 0;
    for (const auto& triangle : triangles) {
      const Vec3 a = positions[triangle[0]] - at, b = positions[triangle[1]] - at,
                 c = positions[triangle[2]] - at;
      const Vec3 middle = (a + b + c) / 3, area = 0.5 * (b - a).cross(c - a);
      const double squared = middle.squaredNorm();
      if (squared > 16 * area.norm()) {  // far enough to be a dipole
        sum += area.dot(middle) / (squared * std::sqrt(squared));
        continue;
      }
      // Solid angle: Van Oosterom, Strackee 1983.
      const double x = a.norm(), y = b.norm(), z = c.norm();
      sum +=
          2 * std::atan2(a.dot(b.cross(c)), x * y * z + a.dot(b) * z + b.dot(c) * x + c.dot(a) * y);
    }
    return sum / (4 * kPi);
  }

  bool is_outside(const Vec3& from, const Vec3& to) const {
    return std::ranges::all_of(std::initializer_list<double>{0.5, 0.25, 0.75}, [&](double share) {
      return std::abs(winding_number(from + share * (to - from))) < kInside;
    });
  }
};

}  // namespace

Diagnostics reference_pose_faults(const Model& model) {
  const Skeleton& skeleton = model.skeleton;
  std::vector<double> moved(skeleton.names.size());  // weights of each joint
  for (std::size_t k = 0; k < model.influence_weights.size(); ++k) {
    moved[model.influence_joints[k]] += static_cast<double>(model.influence_weights[k]);
  }
  Surface surface{{}, model.triangles};
  for (const Vec3f& position : model.positions)
    surface.positions.push_back(position.cast<double>());
  const double shortest = kShortBone * reference_extent(skeleton);
  double all = 0, outside = 0, longest = 0;
  int worst = -1, count = 0;
  for (int j = 0; j < skeleton.joint_count(); ++j) {
    const int parent = skeleton.parents[at(j)];
    if (parent < 0 || moved[at(parent)] < 1) continue;
    const Vec3 from = skeleton.reference[at(parent)].position;
    const Vec3 to = skeleton.reference[at(j)].position;
    const double length = (to - from).norm();
    if (!(length > shortest)) continue;
    all += length;
    if (!surface.is_outside(from, to)) continue;
    outside += length;
    ++count;
    if (length > longest) {
      longest = length;
      worst = j;
    }
  }
  if (!(outside > kSuspicious * all)) return {};
  if (outside > kMost * all && !mesh_volume(surface.positions, model.triangles).closed) return {};
  Diagnostic fault = make_warning(
      "skin-reference-pose",
      fmt::format(
          "{} of the reference pose {} outside of the mesh, such as that from {} to {}: the "
          "skeleton is not in the pose of the mesh, which skinning distorts",
          count == 1 ? "a bone" : fmt::format("{} bones", count), count == 1 ? "lies" : "lie",
          skeleton.names[at(skeleton.parents[at(worst)])], skeleton.names[at(worst)]),
      "export the character in its bind pose, in which the mesh was attached to its joints");
  fault.joint = skeleton.names[at(worst)];
  return {fault};
}

namespace {

constexpr double kThickness = 0.08;     // half-width of a bone, relative to its length
constexpr double kMaxThickness = 0.03;  // relative to the skeleton's extent
constexpr double kWaist = 0.2;          // position of the thickest point along a bone
constexpr double kSmallest = 1e-3;      // shortest bone shown, relative to the skeleton's extent
constexpr double kLoneSize = 0.1;       // metres

// Appends an octahedron from `base` to `tip`: eight triangles without shared vertices.
void add_bone(Model& model, int joint, const Vec3& base, const Vec3& tip, double half_width) {
  const Quat turn = shortest_arc(Vec3::UnitY(), tip - base);
  const Vec3 waist = base + kWaist * (tip - base);
  std::array<Vec3, 4> ring;
  for (int i = 0; i < 4; ++i) {
    const Vec3 corner(i % 2 == 0 ? 1 - i : 0, 0, i % 2 == 1 ? 2 - i : 0);
    ring[i] = waist + turn * (half_width * corner);
  }
  const auto add_triangle = [&](const Vec3& a, const Vec3& b, const Vec3& c) {
    const Vec3f normal = (b - a).cross(c - a).normalized().cast<float>();
    const auto first = static_cast<std::uint32_t>(model.positions.size());
    for (const Vec3& corner : {a, b, c}) {
      model.positions.push_back(corner.cast<float>());
      model.normals.push_back(normal);
      model.influence_joints.push_back(static_cast<std::uint16_t>(joint));
      model.influence_weights.push_back(1.0f);
    }
    model.triangles.push_back({first, first + 1, first + 2});
  };
  // The ring goes +x, +z, -x, -z: clockwise seen from the tip.
  for (int i = 0; i < 4; ++i) {
    const Vec3 &a = ring[i], &b = ring[(i + 1) % 4];
    add_triangle(tip, b, a);
    add_triangle(base, a, b);
  }
}

}  // namespace

Model bone_mesh(const Skeleton& skeleton) {
  Model model;
  model.skeleton = skeleton;
  model.influences_per_vertex = 1;
  const double size = reference_extent(skeleton);
  for (int j = 0; j < skeleton.joint_count(); ++j) {
    const int parent = skeleton.parents[j];
    if (parent == Skeleton::kNoParent) continue;
    const Vec3& base = skeleton.reference[parent].position;
    const Vec3& tip = skeleton.reference[j].position;
    const double length = (tip - base).norm();
    if (!(length > kSmallest * size)) continue;
    add_bone(model, parent, base, tip, std::min(kThickness * length, kMaxThickness * size));
  }
  if (model.positions.empty()) {
    const Vec3& place = skeleton.reference[0].position;
    add_bone(model, 0, place, place + Vec3(0, kLoneSize, 0), kThickness * kLoneSize);
  }
  model.parts.push_back({"bones", "bones", 0, static_cast<std::uint32_t>(model.triangles.size())});
  return model;
}

}  // namespace krok
