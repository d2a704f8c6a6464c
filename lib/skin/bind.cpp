#include "skin/bind.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <unordered_map>

#include "core/numbers.h"
#include "scene/model.h"

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

// The offset of joint `j` in its parent's frame that is nearest to `wanted`, over the reference
// pose and all frames.
Vec3 nearest_place(const Clip& motion, int j, const Vec3& wanted) {
  Vec3 nearest = motion.skeleton.reference_local(j).position;
  const int parent = motion.skeleton.parents[j];
  for (int f = 0; f < motion.frame_count(); ++f) {
    // The offsets of most joints are constant: the reference pose suffices.
    if ((nearest - wanted).norm() <= kPlaceTolerance) break;
    const auto positions = motion.frame_positions(f);
    const Quat orientation = motion.frame_orientations(f)[parent].cast<double>().normalized();
    const Vec3 place = orientation.conjugate() * (positions[j] - positions[parent]).cast<double>();
    if ((place - wanted).norm() < (nearest - wanted).norm()) nearest = place;
  }
  return nearest;
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

// Whether a joint at the root moves away from it, as hips do below a root at the origin.
bool leaves_root(const Clip& motion, int joint) {
  constexpr float kFar = 0.1F;  // metres
  const int parent = motion.skeleton.parents[static_cast<std::size_t>(joint)];
  if (parent < 0 || motion.skeleton.parents[static_cast<std::size_t>(parent)] >= 0) return false;
  float least = std::numeric_limits<float>::infinity(), most = 0;
  for (int f = 0; f < motion.frame_count(); ++f) {
    const auto places = motion.frame_positions(f);
    const float length =
        (places[static_cast<std::size_t>(joint)] - places[static_cast<std::size_t>(parent)]).norm();
    least = std::min(least, length);
    most = std::max(most, length);
  }
  return most - least > kFar;
}

}  // namespace

Diagnostics reference_differences(const Skeleton& model, const Clip& motion) {
  double largest_length = 0, largest_turn = 0;
  int length_joint = 0, turn_joint = 0;
  for (int j = 0; j < model.joint_count(); ++j) {
    // The position of the root does not distort a mesh, nor that of a body below a root that stays
    // behind.
    if (model.parents[j] == Skeleton::kNoParent || leaves_root(motion, j)) continue;
    const Vec3 wanted = model.reference_local(j).position;
    const Vec3 found = nearest_place(motion, j, wanted);
    const double length = std::abs(wanted.norm() - found.norm());
    const double turn = (wanted - found).norm();
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
    const std::string& name = model.names[length_joint];
    result.push_back(warning("skin-proportions", name,
                             fmt::format("the bone to {} is {} mm longer or shorter in the motion "
                                         "than in the model, so the mesh is stretched",
                                         name, readable(largest_length * 1e3, 3)),
                             hint));
  }
  if (largest_turn > kPlaceTolerance) {
    const std::string& name = model.names[turn_joint];
    result.push_back(warning("skin-reference", name,
                             fmt::format("the bone to {} points in different directions in the "
                                         "motion and in the model, so the mesh is bent",
                                         name),
                             hint));
  }
  return result;
}

}  // namespace krok
