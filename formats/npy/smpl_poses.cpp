#include <fmt/format.h>

#include <algorithm>

#include "core/index.h"
#include "formats/npy/array_motion_internal.h"
#include "math/quaternion.h"

namespace krok::npy {

namespace {

// The places of a body's joints in its rest pose, by its model: the regressor's means of the
// vertices, which the shape moves (Loper et al., "SMPL", 2015).
Result<std::vector<Vec3>> joints_of_body(const ArrayFile& file, std::size_t joints) {
  auto body = Arrays::open(file.options.body);
  if (!body) return body.error();
  const ReadOptions plain;
  const ArrayFile model{*body, file.options.columns_name, plain};
  std::vector<std::size_t> vertex_shape = {0, 3}, weights_shape = {0, 0};
  auto vertices = model.numbers("v_template", vertex_shape);
  if (!vertices) return vertices.error();
  const auto weights = model.numbers("J_regressor", weights_shape);
  if (!weights) return weights.error();
  if (weights_shape[1] != vertex_shape[0] || weights_shape[0] < joints) {
    return Error("npy-skeleton",
                 fmt::format("the body has {} joints and {} vertices in J_regressor, the motion {} "
                             "joints, v_template {} vertices",
                             weights_shape[0], weights_shape[1], joints, vertex_shape[0]),
                 "use the body that the motion was made with");
  }
  if (const std::string betas = file.find({"betas", "smpl_betas", "shape"}); !betas.empty()) {
    std::vector<std::size_t> shape;
    const auto sizes = file.numbers(betas, shape);
    if (!sizes) return sizes.error();
    std::vector<std::size_t> directions_shape = {vertex_shape[0], 3, 0};
    if (!sizes->empty() && body->has("shapedirs")) {
      const auto directions = model.numbers("shapedirs", directions_shape);
      if (!directions) return directions.error();
      const std::size_t all = directions_shape[2];
      // Of a table with a row each frame the first, as a body keeps its shape.
      const std::size_t count = std::min(shape.empty() ? 1 : shape.back(), all);
      for (std::size_t v = 0; v < vertices->size(); ++v) {
        for (std::size_t k = 0; k < count; ++k) {
          (*vertices)[v] += (*directions)[v * all + k] * (*sizes)[k];
        }
      }
    }
  }
  std::vector<Vec3> places(joints, Vec3::Zero());
  for (std::size_t j = 0; j < joints; ++j) {
    for (std::size_t v = 0; v < vertex_shape[0]; ++v) {
      const Vec3 vertex((*vertices)[3 * v], (*vertices)[3 * v + 1], (*vertices)[3 * v + 2]);
      places[j] += (*weights)[j * vertex_shape[0] + v] * vertex;
    }
  }
  return places;
}

constexpr std::size_t kBodyJoints = 22;  // others are of hands and face

// Those of a skeleton: in its order, or by names. Hands and face that it lacks are the usual ones.
Result<std::vector<Vec3>> joints_of_skeleton(const Skeleton& given, const Skeleton& smpl) {
  std::vector<Vec3> places;
  const std::size_t common = std::min(given.parents.size(), smpl.parents.size());
  const bool ordered =
      common >= kBodyJoints &&
      std::equal(smpl.parents.begin(), smpl.parents.begin() + std::ptrdiff_t(common),
                 given.parents.begin());
  for (std::size_t j = 0; j < smpl.names.size(); ++j) {
    const bool listed = ordered && at(given.joint_count()) > j;
    const int found = listed ? static_cast<int>(j) : given.find(smpl.names[j]);
    if (found < 0 && j >= kBodyJoints) {
      const std::size_t parent = at(smpl.parents[j]);
      places.push_back(places[parent] + smpl.reference[j].position -
                       smpl.reference[parent].position);
      continue;
    }
    if (found < 0) {
      return Error("npy-skeleton",
                   fmt::format("the skeleton has no joint {}, and others than SMPL in its order",
                               smpl.names[j]),
                   "give one with SMPL's names or in SMPL's order, as krok-import writes with "
                   "--skeleton");
    }
    places.push_back(given.reference[at(found)].position - given.reference[0].position);
  }
  return places;
}

// The rotation vectors of all joints in the order of SMPL, [frames x joints].
struct Poses {
  std::vector<double> values;
  std::size_t frames = 0, joints = 0;
};

Result<Poses> read_poses(const ArrayFile& file) {
  std::vector<std::string> names = {file.find({"poses", "smpl_poses", "full_pose", "thetas"})};
  if (names[0].empty()) {
    names = {file.find({"root_orient", "global_orient"}), file.find({"pose_body", "body_pose"})};
    if (file.arrays.has("pose_hand") || file.arrays.has("left_hand_pose")) {
      names.insert(names.end(), {"pose_jaw", "jaw_pose", "pose_eye", "leye_pose", "reye_pose",
                                 "pose_hand", "left_hand_pose", "right_hand_pose"});
    }
    std::erase_if(names, [&](const std::string& name) { return !file.arrays.has(name); });
  }
  Poses poses;
  std::vector<std::vector<double>> parts;
  for (const std::string& name : names) {
    std::vector<std::size_t> shape;
    auto values = file.numbers(name, shape);
    if (!values) return values.error();
    if (shape.empty() || shape[0] == 0) return Error("npy-shape", name + " has no frames");
    const std::size_t size = values->size() / shape[0];
    if (size % 3 != 0 || (!parts.empty() && shape[0] != poses.frames)) {
      return Error("npy-shape",
                   fmt::format("{} has the shape {}: not a rotation vector of three numbers for "
                               "each joint and frame",
                               name, shape_text(shape)));
    }
    poses.frames = shape[0];
    poses.joints += size / 3;
    parts.push_back(*std::move(values));
  }
  for (std::size_t f = 0; f < poses.frames; ++f) {
    for (const std::vector<double>& part : parts) {
      const auto size = static_cast<std::ptrdiff_t>(part.size() / poses.frames);
      const auto from = part.begin() + static_cast<std::ptrdiff_t>(f) * size;
      poses.values.insert(poses.values.end(), from, from + size);
    }
  }
  return poses;
}

}  // namespace

Result<ArrayMotion> read_smpl(const ArrayFile& file) {
  const auto poses = read_poses(file);
  if (!poses) return poses.error();
  const std::size_t frames = poses->frames, joints = poses->joints;
  const char* const kind = joints == 22   ? "smpl22"
                           : joints == 24 ? "smpl24"
                           : joints == 52 ? "smplh52"
                           : joints == 55 ? "smplx55"
                                          : nullptr;
  if (kind == nullptr) {
    return Error(
        "npy-shape",
        fmt::format("the poses have {} joints: SMPL has 22 or 24, SMPL-H 52, SMPL-X 55", joints),
        "hands in principal components are to be turned into rotations before");
  }
  auto arranged = arrange(*named_skeleton(kind));
  if (!arranged) return arranged.error();
  ArrayMotion motion;
  motion.upright = true;
  motion.skeleton = std::move(arranged->skeleton);
  motion.roles = std::move(arranged->roles);
  std::vector<Vec3> roots(frames, Vec3::Zero());
  if (const auto name = file.find({"trans", "smpl_trans", "transl"}); !name.empty()) {
    const auto moved = file.numbers(name, {frames, 3});
    if (!moved) return moved.error();
    for (std::size_t f = 0; f < frames; ++f) roots[f] = Vec3(&(*moved)[3 * f]);
  }
  std::optional<std::vector<Vec3>> places;
  if (!file.options.body.empty()) {
    auto found = joints_of_body(file, joints);
    if (!found) return found.error();
    places = *std::move(found);
  } else if (file.options.skeleton) {
    auto found = joints_of_skeleton(*file.options.skeleton, motion.skeleton);
    if (!found) return found.error();
    places = *std::move(found);
  } else {
    motion.diagnostics.push_back(make_warning(
        "npy-body",
        "the file has rotations without a body: one of 1.72 m with usual proportions is used, so "
        "that feet may float or slide",
        "--skeleton with a model of SMPL (.npz), or with a BVH file of the body"));
  }
  for (std::size_t j = 0; places && j < joints; ++j) {
    motion.skeleton.reference[j].position = (*places)[j];
  }
  constexpr double kTwoTurns = 4 * kPi;
  const double largest = std::ranges::max(poses->values, {}, [](double v) { return std::abs(v); });
  if (std::abs(largest) > kTwoTurns) {
    return Error("npy-rotation",
                 fmt::format("a rotation vector has the value {}; radians are needed", largest),
                 "degrees? then numpy.radians(poses)");
  }
  std::vector<Quat> rotations;
  for (std::size_t i = 0; i < frames * joints; ++i) {
    rotations.push_back(from_rotation_vector(Vec3(&poses->values[3 * i])));
  }
  for (Vec3& root : roots) root += motion.skeleton.reference[0].position;
  pose_frames(rotations, roots, motion);
  return motion;
}

bool is_smpl_body(std::span<const std::byte> file) {
  const auto arrays = Arrays::open(file);
  return arrays && arrays->has("v_template") && arrays->has("J_regressor");
}

}  // namespace krok::npy
