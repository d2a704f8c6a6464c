#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>

#include "core/index.h"
#include "core/numbers.h"
#include "core/text.h"
#include "formats/npy/array_motion_internal.h"
#include "math/quaternion.h"
#include "positions/from_positions.h"

// Positions of joints, alone or with rotations.

namespace krok::npy {

namespace {

constexpr const char* kSkeletonHint = "say what its joints are: --skeleton NAME or NAME.json";

// How to bring an array into order.
std::string advice_on_axes(std::span<const std::size_t> shape) {
  const auto is_body = [](std::size_t size) { return !skeletons_of_columns(size).empty(); };
  const std::size_t last = shape.empty() ? 0 : shape.back();
  if (shape.size() == 2 && last == 3) return "one frame? then a[None]";
  if (shape.size() == 2 && last % 3 == 0) {
    return fmt::format(
        "positions of {} joints in a row? then a.reshape(-1, {}, 3); rotation vectors of SMPL are "
        "read from an .npz as \"poses\", with \"trans\"",
        last / 3, last / 3);
  }
  if (shape.size() == 2 && (last == 263 || last == 251)) {
    return "HumanML3D's features? its recover_from_ric() makes positions of them";
  }
  const auto three = std::ranges::find(shape, 3U);
  if (three == shape.end() && last == 4) return "x, y, z and another number? then a[..., :3]";
  if (three == shape.end() && last == 2) return "places in an image: depth is needed, too";
  if (three == shape.end()) return "save the array with the axes frames, joints, x y z";
  const std::ptrdiff_t axis = three - shape.begin();
  if (shape.size() == 4 && axis == 2) {
    return "motions, joints, x y z, frames? then a.transpose(0, 3, 1, 2)";
  }
  if (shape.size() == 3 && axis == 1 && is_body(shape[0]) && !is_body(shape[2])) {
    return "joints, x y z, frames? then a.transpose(2, 0, 1)";
  }
  return fmt::format("axis {} has three elements: numpy.moveaxis(a, {}, -1) makes it the last",
                     axis, axis);
}

}  // namespace

Result<ArrayMotion> motion_of_positions(const ArrayFile& file, const std::string& name) {
  auto array = file.arrays.read(name);
  if (!array) return array.error();
  ArrayMotion motion;
  motion.upright = true;
  std::vector<std::size_t>& shape = array->shape;
  const std::string text = shape_text(shape);
  const std::string what = name.empty() ? "the array" : name;
  if (!array->is_number() || shape.size() < 3 || shape.size() > 4 || shape.back() != 3) {
    return Error("npy-shape",
                 fmt::format("{} has the shape {}; (frames, joints, 3) is needed, or (motions, "
                             "frames, joints, 3)",
                             what, text),
                 advice_on_axes(shape));
  }
  if (array->data.empty()) return Error("npy-shape", fmt::format("{} has no frames", what));
  const std::size_t columns = shape[shape.size() - 2], frames = shape[shape.size() - 3];
  auto arranged = skeleton_for(file, columns, motion.usual_rate, motion.diagnostics);
  if (!arranged) {
    const auto& given = file.options.columns;
    if (given ? at(given->columns()) == frames : !skeletons_of_columns(frames).empty()) {
      arranged.error().hint =
          fmt::format("joints before frames? numpy.swapaxes(a, {}, {}) exchanges them",
                      shape.size() - 3, shape.size() - 2);
    }
    arranged.error().message += fmt::format("; the shape is {}", text);
    return arranged.error();
  }
  const std::size_t size = frames * columns * 3;
  int wanted = 0;
  if (shape.size() == 4) {
    motion.motions = shape[0];
    wanted = file.options.motion.value_or(0);
    if (wanted < 0 || at(wanted) >= motion.motions) {
      return Error("npy-shape", fmt::format("there is no motion {} among {}", wanted, shape[0]),
                   "motions are counted from 0");
    }
    if (motion.motions > 1 && !file.options.motion) {
      motion.diagnostics.push_back(make_warning(
          "npy-motion", fmt::format("the file holds {} motions, the first is used", shape[0]),
          frames == 1 ? "one motion of so many frames? then a[:, 0]"
                      : "krok-import --clip NUMBER takes another, --clip all writes all"));
    }
  }
  const std::vector<double> values = array->numbers(at(wanted) * size, size);
  const std::size_t joints = arranged->columns.size();
  motion.positions.assign(frames * joints, Vec3::Zero());
  for (std::size_t i = 0; i < motion.positions.size(); ++i) {
    const std::vector<int>& from = arranged->columns[i % joints];
    for (const int column : from) {
      motion.positions[i] += Vec3(&values[3 * (i / joints * columns + at(column))]);
    }
    motion.positions[i] /= static_cast<double>(from.size());
    if (!motion.positions[i].allFinite()) motion.gaps.push_back(i);
  }
  if (!motion.gaps.empty()) {
    const std::size_t first = motion.gaps.front();
    const bool repair = file.options.strictness == Strictness::repair;
    Error error("npy-value",
                fmt::format("{} of {} places of joints in {} are missing (nan or infinite), first "
                            "of {} in frame {}",
                            motion.gaps.size(), frames * joints, what,
                            shown(arranged->skeleton.names[first % joints]), first / joints),
                repair ? "a joint is missing in all frames"
                       : "--repair fills gaps from the frames before and after");
    error.joint = arranged->skeleton.names[first % joints];
    error.frame = static_cast<std::int64_t>(first / joints);
    if (!repair || !fill_gaps(arranged->skeleton.parents, motion.positions)) return error;
    error.severity = Severity::warning;
    error.code = "npy-repair";
    error.message += ": filled from the frames before and after";
    error.hint.clear();
    motion.diagnostics.push_back(error);
  }
  motion.skeleton = std::move(arranged->skeleton);
  motion.roles = std::move(arranged->roles);
  motion.columns = std::move(arranged->columns);
  return motion;
}

Result<ArrayMotion> motion_of_rotations(const ArrayFile& file, const std::string& positions,
                                        const std::string& rotations, bool global) {
  auto motion = motion_of_positions(file, positions);
  if (!motion) return motion;
  const std::size_t joints = motion->skeleton.names.size();
  const std::size_t frames = motion->positions.size() / joints;
  for (std::size_t j = 0; j < joints; ++j) {
    if (motion->columns[j].size() == 1) continue;
    return Error("npy-skeleton",
                 fmt::format("{} is the mean of several joints, so that {} has no rotation of it",
                             motion->skeleton.names[j], rotations),
                 kSkeletonHint);
  }
  const auto values = file.numbers(rotations, {frames, joints, 3, 3});
  if (!values) return values.error();
  motion->orientations.resize(frames * joints);
  for (std::size_t f = 0; f < frames; ++f) {
    for (std::size_t j = 0; j < joints; ++j) {
      const std::size_t column = at(motion->columns[j][0]);
      const Mat3 matrix = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(
          &(*values)[9 * (f * joints + column)]);
      if (!(matrix * matrix.transpose()).isIdentity(0.02) || !(matrix.determinant() > 0)) {
        Error error("npy-rotation", fmt::format("{} has a matrix that is no rotation", rotations),
                    "save rotation matrices, each with its rows and columns");
        error.joint = motion->skeleton.names[j];
        error.frame = static_cast<std::int64_t>(f);
        return error;
      }
      Quat turn = Quat(matrix).normalized();
      const int parent = motion->skeleton.parents[j];
      if (!global && parent >= 0) turn = motion->orientations[f * joints + at(parent)] * turn;
      motion->orientations[f * joints + j] = turn.normalized();
    }
  }
  motion->upright = false;
  // Bones as the rotations have them: the mean in their parents' frames.
  double worst = 0;
  for (std::size_t j = 1; j < joints; ++j) {
    const std::size_t parent = at(motion->skeleton.parents[j]);
    const auto offset = [&](std::size_t f) -> Vec3 {
      return motion->orientations[f * joints + parent].conjugate() *
             (motion->positions[f * joints + j] - motion->positions[f * joints + parent]);
    };
    Vec3 mean = Vec3::Zero();
    for (std::size_t f = 0; f < frames; ++f) mean += offset(f) / static_cast<double>(frames);
    for (std::size_t f = 0; f < frames; ++f) {
      worst = std::max(worst, (offset(f) - mean).norm() / std::max(mean.norm(), 1e-3));
    }
    motion->skeleton.reference[j].position = motion->skeleton.reference[parent].position + mean;
  }
  if (worst > 0.05) {
    motion->diagnostics.push_back(make_warning(
        "npy-rotation",
        fmt::format("the positions do not follow the rotations in {}: a bone moves by {}% of its "
                    "length in the frame of its parent",
                    rotations, readable(100 * worst, 3)),
        "are they of other axes, or of other frames?"));
  }
  return motion;
}

namespace {

// As the file's own arrays of names and parents have them.
Result<PositionSkeleton> stated_columns(const ArrayFile& file, std::size_t columns) {
  const auto names = file.arrays.read("names");
  if (!names) return names.error();
  const auto parents = file.numbers("parents", {columns});
  if (!parents) return parents.error();
  const std::vector<std::string> texts = names->texts();
  if (texts.size() != columns) {
    return Error("npy-shape",
                 fmt::format("there are {} joints and {} names", columns, texts.size()));
  }
  PositionSkeleton skeleton;
  for (std::size_t j = 0; j < columns; ++j) {
    const double parent = (*parents)[j];
    if (!(parent < static_cast<double>(columns))) {
      return Error("npy-value", fmt::format("parents has {} for joint {}", parent, j));
    }
    PositionJoint& joint = skeleton.joints.emplace_back();
    joint.name = texts[j];
    if (parent >= 0) joint.parent = texts[static_cast<std::size_t>(parent)];
  }
  return skeleton;
}

}  // namespace

Result<ArrangedSkeleton> skeleton_for(const ArrayFile& file, std::size_t columns,
                                      double& usual_rate, Diagnostics& diagnostics) {
  const std::vector<std::string_view> known = skeletons_of_columns(columns);
  const std::string hint =
      known.empty() ? kSkeletonHint
                    : fmt::format("of {} joints: --skeleton {}", columns, fmt::join(known, " or "));
  const auto other_number = [&](int expected) {
    return Error("npy-skeleton",
                 fmt::format("there are {} joints, {} has {}", columns,
                             shown(file.options.columns_name), expected),
                 hint);
  };
  if (file.options.skeleton) {
    ArrangedSkeleton arranged;
    arranged.skeleton = *file.options.skeleton;
    const int joints = arranged.skeleton.joint_count();
    if (at(joints) != columns) return other_number(joints);
    arranged.roles = find_roles(arranged.skeleton);
    for (int j = 0; j < joints; ++j) arranged.columns.push_back({j});
    return arranged;
  }
  std::optional<PositionSkeleton> skeleton = file.options.columns;
  if (!skeleton && file.arrays.has("names") && file.arrays.has("parents")) {
    auto stated = stated_columns(file, columns);
    if (!stated) return stated.error();
    skeleton = *std::move(stated);
  }
  if (!skeleton) {
    if (known.size() != 1) {
      return Error("npy-skeleton",
                   fmt::format("there are {} joints, of {} by their number", columns,
                               known.empty() ? "no known skeleton" : "several skeletons"),
                   hint);
    }
    skeleton = named_skeleton(known[0]);
    if (file.find({"global_rot_mats", "local_rot_mats"}).empty()) {
      diagnostics.push_back(
          make_warning("npy-skeleton", fmt::format("{} joints are taken for {}", columns, known[0]),
                       kSkeletonHint));
      diagnostics.back().where.file = file.name;
    }
  }
  if (at(skeleton->columns()) != columns) return other_number(skeleton->columns());
  usual_rate = skeleton->rate;
  return arrange(*skeleton);
}

}  // namespace krok::npy
