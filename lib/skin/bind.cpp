#include "skin/bind.h"

#include <fmt/format.h>

#include <cmath>
#include <unordered_map>

#include "core/numbers.h"
#include "math/quaternion.h"
#include "scene/influences.h"

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
  Diagnostic result;
  result.severity = Severity::warning;
  result.code = std::move(code);
  result.joint = std::move(joint);
  result.message = std::move(message);
  result.hint = std::move(hint);
  return result;
}

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
    return missing_joints(missing, fmt::format("the motion's joints are {}, ...; the model and the "
                                               "motion must come from the same skeleton",
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

Diagnostics reference_differences(const Skeleton& model, const Skeleton& motion) {
  double largest_length = 0, largest_angle = 0;
  int length_joint = 0, angle_joint = 0;
  for (int j = 0; j < model.joint_count(); ++j) {
    const Transform a = model.reference_local(j), b = motion.reference_local(j);
    const bool root = model.parents[j] == Skeleton::kNoParent;
    // Where the root stands does not distort a mesh.
    const double length = root ? 0.0 : std::abs(a.position.norm() - b.position.norm());
    const double angle =
        angle_between(model.reference[j].orientation, motion.reference[j].orientation);
    if (length > largest_length) largest_length = length, length_joint = j;
    if (angle > largest_angle) largest_angle = angle, angle_joint = j;
  }
  Diagnostics result;
  if (largest_length > 1e-3) {
    const std::string& name = model.names[length_joint];
    result.push_back(warning(
        "skin-proportions", name,
        fmt::format("the bone to {} differs by {} mm between model and motion, so the mesh is "
                    "stretched",
                    name, readable(largest_length * 1e3, 3)),
        "make the model for this motion's skeleton"));
  }
  if (largest_angle > kRadiansPerDegree) {
    const std::string& name = model.names[angle_joint];
    result.push_back(warning(
        "skin-reference", name,
        fmt::format("the reference poses of model and motion differ by {} degrees at {}, so the "
                    "mesh is bent",
                    readable(largest_angle / kRadiansPerDegree, 3), name),
        "make the model for this motion's skeleton"));
  }
  return result;
}

}  // namespace krok
